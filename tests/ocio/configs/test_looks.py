import functools
import json
from dataclasses import asdict
from itertools import islice
from unittest.mock import Mock

import numpy as np
import pytest

from crfnet.configs.looks import read_looks
from crfnet.defaults import ESTIMATES
from crfnet.errors import ConfigError, LutError
from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import Lut1D
from crfnet.luts.rgb_lut import RgbLut1D
from crfnet.output_files import LONGEST_STEM, distinct_names
from crfnet_core.colorimetry import AP1, DISPLAY_P3, REC709, Primaries
from tests.helpers.folders import written
from tests.helpers.looks import LUT, OTHER_LUT, write_look
from tests.helpers.refusals import refusal_of


def refusal(folder, root, *keys):
    """Return the code of the refusal of the sample's document, in which the entry at the keys is the last of them."""
    document = json.loads((root / "docs" / "sample" / "plate.json").read_text())
    *path, key, value = keys
    functools.reduce(lambda part, name: part[name], path, document)[key] = value
    return refusal_of(ConfigError, read_looks, written(folder / "plate.json", json.dumps(document))).code


def test_folder_document_and_lut_are_one_look(tmp_path):
    folder = write_look(tmp_path / "look", exposure=1.5, interop_id="lin_ap1_scene")
    looks = [*read_looks(folder), *read_looks(folder / "plate01.json"), *read_looks(folder / "plate01.spi1d")]
    assert len({look.space for look in looks}) == 1
    space = looks[0].space
    assert (space.name, space.exposure, space.file_patterns) == ("CRF plate01", 1.5, ("plate01.jpg",))
    assert (space.linear_patterns, space.linear_primaries) == (("plate01_linear.exr",), AP1)
    assert [(look.folder, look.lut == LUT) for look in looks] == [("look", True)] * 3


def test_primaries_are_those_of_the_document(tmp_path):
    wide = Primaries("my camera", (0.7, 0.3), (0.2, 0.7), (0.1, 0.05))
    for primaries in (DISPLAY_P3, REC709, wide):
        (look,) = read_looks(write_look(tmp_path / "look", primaries=primaries))
        assert look.space.primaries == primaries


def test_the_exposure_may_be_edited_in_the_looks_config(tmp_path):
    folder = write_look(tmp_path / "look", exposure=1.5)
    text = (folder / "config.ocio").read_text()
    written(folder / "config.ocio", text.replace("exposure: 1.5", "exposure: -2"))
    assert read_looks(folder)[0].space.exposure == -2
    (folder / "config.ocio").unlink()
    assert read_looks(folder)[0].space.exposure == 1.5


def test_many_estimates_have_folders_of_their_own(tmp_path):
    write_look(tmp_path / "all" / "a", ["a.jpg"])
    write_look(tmp_path / "all" / "b", ["b.jpg"])
    assert refusal_of(ConfigError, read_looks, tmp_path / "all").code == "folder_without_look"
    (tmp_path / "all" / ESTIMATES).write_text("")
    assert [look.space.name for look in read_looks(tmp_path / "all")] == ["CRF a", "CRF b"]


@pytest.mark.parametrize("suffix", [".cube", ".clf", ".spi1d"])
def test_a_lut_from_elsewhere_will_do(tmp_path, suffix):
    write_lut(tmp_path / f"cam{suffix}", LUT)
    (look,) = read_looks(tmp_path / f"cam{suffix}")
    assert (look.space.name, look.space.exposure, look.space.file_patterns) == ("CRF cam", 0, ())
    assert (look.space.linear_patterns, look.space.linear_primaries, look.lut) == ((), None, LUT)


@pytest.mark.parametrize(
    ("name", "content", "code"),
    [("empty", None, "folder_without_look"), ("a.json", "{}", "not_a_look"), ("a.jpg", "no json", "not_a_look")],
)
def test_anything_else_is_refused(tmp_path, name, content, code):
    path = tmp_path / name
    path.mkdir() if content is None else path.write_text(content)
    assert refusal_of(ConfigError, read_looks, path).code == code


@pytest.mark.parametrize("name", ["", "a.json", "a.spi1d"])
def test_a_document_that_may_not_be_read_is_not_passed_over(tmp_path, monkeypatch, name):
    """Not even in a folder of several, or next to a LUT: a plate, or its exposure, would be lost."""
    write_look(tmp_path, ["a.jpg"])
    monkeypatch.setattr("crfnet.configs.looks.read_json", Mock(side_effect=PermissionError(13, "Permission denied")))
    assert refusal_of(ConfigError, read_looks, tmp_path / name).code == "not_opened"


@pytest.mark.parametrize(
    "name", ["", "../plate.spi1d", "a/b.spi1d", "\ud800.spi1d", "a\udce9.spi1d", "a\0.spi1d", 5, None]
)
def test_a_document_does_not_lead_out_of_its_folder(tmp_path, root, name):
    assert refusal(tmp_path, root, "files", "spi1d", name) == "not_a_look"
    assert refusal(tmp_path, root, "photographs", 0, "name", name) == "not_a_look"


@pytest.mark.parametrize(
    "change",
    [
        *(dict.fromkeys(("red", "green", "blue", "white"), point) for point in ([1, 0], [0.3127, 0.329])),
        *({"red": point} for point in ([True, True], [1e300, 1e-300], [0.64], ["0.64", "0.33"], 5)),
        *({"white": point} for point in ([0.64, 1e-320], [0.3, -0.1], [0.3, 0])),
    ],
)
def test_primaries_that_make_no_matrix_are_refused(tmp_path, root, change):
    assert refusal(tmp_path, root, "primaries", asdict(REC709) | change) == "not_a_look"


@pytest.mark.parametrize("stops", [2000, 1e308, True])
def test_an_exposure_beyond_single_precision_is_refused(tmp_path, root, stops):
    (tmp_path / "plate.spi1d").write_bytes((root / "docs" / "sample" / "plate.spi1d").read_bytes())
    assert refusal(tmp_path, root, "exposure", "stops", stops) == "not_a_look"


def test_a_missing_lut_is_named(tmp_path):
    folder = write_look(tmp_path / "look")
    (folder / "plate01.spi1d").unlink()
    assert refusal_of(LutError, read_looks, folder).code == "lut_unreadable"


def test_a_lut_of_another_kind_is_refused(tmp_path):
    write_lut(tmp_path / "forward.spi1d", Lut1D(np.linspace(0, 1, 256) ** 0.45))
    write_lut(tmp_path / "rgb.cube", RgbLut1D((LUT, LUT, OTHER_LUT)))
    for name in ("forward.spi1d", "rgb.cube"):
        assert refusal_of(LutError, read_looks, tmp_path / name).code == "lut_without_inverse_response"


def test_the_files_of_plates_of_one_long_name_can_be_written():
    names = [*islice(distinct_names("x" * LONGEST_STEM, "ä" * 100), 3)]
    assert len({*names}) == 3
    assert max(len(name.encode()) for name in names) <= 255 - len(".spi1d")
