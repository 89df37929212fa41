from collections import defaultdict
from contextlib import suppress
from itertools import product

import numpy as np
import PyOpenColorIO as OCIO
import pytest

from crfnet.configs.derived import write_derived_config
from crfnet.configs.looks import Look, read_looks
from crfnet.configs.sources import find_config
from crfnet_core.errors import CRFNetError
from tests.helpers.configs import converted, loaded
from tests.helpers.looks import STUDIO, add, all_names, space_of, write_look
from tests.helpers.mutations import mutated, mutated_text

#: Words that are put into configs, with bars between.
WORDS = (
    "search_path: [., luts, .]|search_path: $A:/x|inactive_colorspaces: [a, A]|&a|*a|!<Look>|!<FileTransform> {src: x}|"
    "ocio_profile_version: 2.4|ocio_profile_version: 1|strictparsing: false|environment: {A: $A}|"
    "family: Camera Response|"
    r"name: CRF plate01|aliases: [crf_plate01]|roles: {}|shared_views: [a]|!<Views> [a]|isdata: true|regex: .*|{|[|- |"
    r'name: "\ud800"|"\xff"'
)


@pytest.fixture(scope="module")
def seeds(tmp_path_factory, root):
    """The text of small configs: of an estimate, of one with two plates, and built-in ones."""
    folder = tmp_path_factory.mktemp("seeds")
    done = add("cg-config-v1.0.0_aces-v1.3_ocio-v2.1", folder / "cg", write_look(folder / "look", ["shot.0001.jpg"]))
    return [path.read_text() for path in (root / "docs" / "sample" / "config.ocio", done.path)]


def conversions(config, names):
    """Return what becomes of a few colors, or None where OpenColorIO refuses, for each color space."""
    results, colors = [], np.linspace(0, 1, 12).reshape(-1, 3)
    for name in names:
        try:
            results.append(converted(config, name, "scene_linear", colors).tolist())
        except (OCIO.Exception, OCIO.ExceptionMissingFile):
            results.append(None)
    return results


def test_damaged_configs_mean_the_same_with_a_plate_or_are_refused(fuzz, seeds, tmp_path):
    looks, path = read_looks(write_look(tmp_path / "look")), tmp_path / "base" / "config.ocio"
    path.parent.mkdir()

    def case(generator):
        text = seeds[generator.integers(len(seeds))]
        is_binary = generator.random() < 0.3
        content = mutated_text(text, generator, WORDS.split("|")).encode(errors="surrogatepass")
        path.write_bytes(mutated(text.encode(), generator) if is_binary else content)
        with suppress(CRFNetError):
            done = write_derived_config(find_config(str(path)), tmp_path / "show", looks, overwrite=True)
            base, result = loaded(path), loaded(done.path)
            assert all_names(result) == all_names(base)
            names = all_names(base)["spaces"]
            assert repr(conversions(result, names)) == repr(conversions(base, names))

    fuzz(case)


def test_a_file_has_the_space_of_its_only_plate_or_that_of_the_base(fuzz, tmp_path):
    base, spaces = find_config(STUDIO), {"lin_rec709_scene": "Linear Rec.709 (sRGB)", "unknown": ""}
    stems = ("bg", "BG", "bg_linear", "shot.0001", "shot.0002", "a", "a linear", "größe", "GRÖßE", "IMG_0042")
    plates = list[tuple[str, str, Look]]()
    for stem, (name, space) in product(stems, spaces.items()):
        look = read_looks(write_look(tmp_path / str(len(plates)), [f"{stem}.png"], interop_id=name))[0]
        plates.append((stem.lower().replace("0001", "0002"), space, look))

    def case(generator):
        source, expected = base, defaultdict(set)
        for step in ("one", "two"):
            chosen = [plates[index] for index in generator.choice(len(plates), 3, replace=False)]
            done = write_derived_config(source, tmp_path / step, [look for *_, look in chosen], overwrite=True)
            source = find_config(str(done.path))
            for (stem, space, _), plate in zip(chosen, done.plates, strict=True):
                expected[f"{stem}.png"].add("" if stem.startswith("img") else plate.name)
                expected[f"{stem}_linear.exr"].add(space)
        for name, found in [*expected.items(), *((f"x{name}", ()) for name in expected)]:
            space = found.pop() if len(found) == 1 else ""
            assert space_of(source.config, f"/x/{name.upper()}") == (space or space_of(base.config, name))

    fuzz(case)
