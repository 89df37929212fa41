"""A config of plates alone, merged by OpenColorIO itself: right colours, and nothing of ours replaces the studio's."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import PyOpenColorIO as OCIO
import pytest

from crfnet.configs.portable import portable_config
from crfnet.configs.reference_space import REC709_TO_AP0
from crfnet.configs.studio.looks import read_looks
from crfnet.configs.studio.overlay import write_overlay
from crfnet.configs.studio.sources import find_config
from crfnet.errors import ConfigError
from crfnet.luts.lut1d import inverse_response_lut
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.configs import converted, loaded, rule_names
from tests.helpers.folders import listed, tree
from tests.helpers.looks import LUT, NAME, OTHER_LUT, STUDIO, add, space_of, write_look

EVERY_SPACE = (OCIO.SEARCH_REFERENCE_SPACE_ALL, OCIO.COLORSPACE_ALL)

#: One with rules for .exr, one without, one of another profile.
BASES = (STUDIO, "studio-config-v2.2.0_aces-v1.3_ocio-v2.4", "cg-config-v1.0.0_aces-v1.3_ocio-v2.1")

#: The response that is nearest to a studio's own space "Gamma 2.2 Encoded Rec.709".
GAMMA_LUT = inverse_response_lut(ResponseCurve.gamma(2.2))


def overlay(base, look, out, **options):
    return write_overlay(find_config(str(base)), out, read_looks(look), **options)


def merged(done):
    """The merged config, by OpenColorIO's own tool."""
    if not hasattr(OCIO, "ConfigMerger"):
        pytest.skip("OpenColorIO merges configs from version 2.5 on")
    out = done.config.with_name("merged.ocio")
    tool = str(Path(sys.executable).with_name("ociomergeconfigs"))
    run = subprocess.run([tool, str(done.merge_file), "--out", str(out), "--validate"], capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
    return loaded(out)


def is_right_in_aces(config, lut):
    pixels = np.random.default_rng(0).uniform(0, 1, (200, 3)).astype(np.float32)
    pixels[0] = 0.5
    expected = lut.apply(pixels) @ np.transpose(REC709_TO_AP0)
    return np.abs(converted(config, NAME, "aces_interchange", pixels) - expected).max() < 1e-5


@pytest.mark.parametrize("lut", [LUT, GAMMA_LUT], ids=["camera", "gamma"])
@pytest.mark.parametrize("name", BASES)
def test_merging_adds_the_plate_and_nothing_else(name, lut, tmp_path):
    base = OCIO.Config.CreateFromBuiltinConfig(name)
    found = merged(overlay(name, write_look(tmp_path / "look", lut=lut), tmp_path / "show" / "overlay.ocio"))
    assert set(found.getColorSpaceNames(*EVERY_SPACE)) - set(base.getColorSpaceNames(*EVERY_SPACE)) == {NAME}
    assert set(base.getColorSpaceNames(*EVERY_SPACE)) <= set(found.getColorSpaceNames(*EVERY_SPACE))
    assert list(found.getNamedTransformNames()) == list(base.getNamedTransformNames())
    assert dict(found.getRoles()) == dict(base.getRoles())
    assert rule_names(found) == rule_names(base)
    for path in ("b.exr", "b.jpg", "plate01.jpg", "plate01_linear.exr", "b.mov"):
        assert space_of(found, path) == space_of(base, path)
    assert list(found.getDisplays()) == list(base.getDisplays())
    for display in base.getDisplays():
        assert list(found.getViews(display)) == list(base.getViews(display))
    for space in base.getColorSpaces():
        assert str(found.getColorSpace(space.getName())) == str(space)
    assert is_right_in_aces(found, lut)


def test_a_config_with_another_reference_gets_the_plate_converted(tmp_path):
    """Ours has linear Rec.709."""
    path = tmp_path / "show" / "studio.ocio"
    path.parent.mkdir()
    path.write_text(portable_config([]).serialize())
    found = merged(overlay(path, write_look(tmp_path / "look", exposure=1), tmp_path / "show" / "overlay.ocio"))
    np.testing.assert_allclose(
        converted(found, NAME, "scene_linear", [[0.5] * 3]), 2 * LUT.apply([[0.5] * 3]), atol=1e-5
    )
    assert "Non-Color" in list(found.getColorSpaceNames())


@pytest.mark.parametrize("name", BASES)
def test_the_space_alone_is_right_too(name, tmp_path):
    """ConfigMergingHelpers.MergeColorSpace converts nothing, so the overlay has the reference of the ACES configs."""
    if not hasattr(OCIO, "ConfigMergingHelpers"):
        pytest.skip("OpenColorIO merges configs from version 2.5 on")
    done = overlay(name, write_look(tmp_path / "look"), tmp_path / "show" / "overlay.ocio")
    space = loaded(done.config).getColorSpace(NAME)
    parameters = OCIO.ConfigMergingParameters.Create()
    base = OCIO.Config.CreateFromBuiltinConfig(name)
    found = OCIO.ConfigMergingHelpers.MergeColorSpace(parameters, base, space)
    found.setWorkingDir(str(done.config.parent))
    assert is_right_in_aces(found, LUT)


def test_the_overlay_is_valid_and_small(tmp_path):
    done = overlay(STUDIO, write_look(tmp_path / "look"), tmp_path / "overlay.ocio")
    found = loaded(done.config)
    found.validate()
    assert list(found.getColorSpaceNames()) == ["ACES2065-1", NAME]
    assert rule_names(found) == ["Default"]
    assert found.getColorSpaceFromFilepath("plate01.jpg")[0] == "default"
    assert listed(tmp_path) == ["look", "overlay.ocio", "overlay.ociom", "overlay_camera_response"]


def test_two_plates_of_one_name_are_two(tmp_path):
    looks = [*read_looks(write_look(tmp_path / "a")), *read_looks(write_look(tmp_path / "b", lut=OTHER_LUT))]
    done = write_overlay(find_config(STUDIO), tmp_path / "overlay.ocio", looks)
    assert [plate.name for plate in done.plates] == [NAME, "CRF plate01 (b)"]
    found = converted(loaded(done.config), "CRF plate01 (b)", "ACES2065-1", [[0.5] * 3])
    np.testing.assert_allclose(found, OTHER_LUT.apply([[0.5] * 3]), atol=1e-5)


def test_the_same_gives_the_same_bytes_and_is_replaced_only_when_asked(tmp_path):
    look = write_look(tmp_path / "look")
    overlay(STUDIO, look, tmp_path / "show" / "overlay.ocio")
    before = tree(tmp_path / "show")
    with pytest.raises(ConfigError, match=r"overlay\.ocio: exists already"):
        overlay(STUDIO, look, tmp_path / "show" / "overlay.ocio")
    overlay(STUDIO, look, tmp_path / "show" / "overlay.ocio", overwrite=True)
    assert tree(tmp_path / "show") == before


def test_the_studios_config_is_not_replaced(tmp_path):
    path = tmp_path / "config.ocio"
    path.write_text(portable_config([]).serialize())
    before = path.read_bytes()
    with pytest.raises(ConfigError, match="is the config to merge with; choose another name for the overlay"):
        overlay(path, write_look(tmp_path / "look"), path, overwrite=True)
    assert path.read_bytes() == before


def test_a_base_that_has_the_new_name_of_a_plate_is_refused(tmp_path):
    """The second plate of a name is called after its folder."""
    base = add(STUDIO, write_look(tmp_path / "c", ["plate01 (b).jpg"]), tmp_path / "show" / "studio.ocio").config
    looks = [*read_looks(write_look(tmp_path / "a")), *read_looks(write_look(tmp_path / "b", lut=OTHER_LUT))]
    with pytest.raises(ConfigError, match=r"has a colour space 'CRF plate01 \(b\)'"):
        write_overlay(find_config(str(base)), tmp_path / "overlay.ocio", looks)


def test_a_base_that_has_the_plate_already_is_refused(tmp_path):
    """The merger would keep the base's, with another response."""
    base = add(STUDIO, write_look(tmp_path / "a"), tmp_path / "show" / "studio.ocio").config
    before = tree(tmp_path)
    with pytest.raises(ConfigError, match=rf"has a colour space '{NAME}', which would win .*crfnet config remove"):
        overlay(base, write_look(tmp_path / "a", lut=OTHER_LUT), tmp_path / "show" / "overlay.ocio")
    assert listed(tmp_path / "show") == ["studio.ocio", "studio_camera_response"]
    assert tree(tmp_path / "show") == {name[5:]: text for name, text in before.items() if name.startswith("show/")}
