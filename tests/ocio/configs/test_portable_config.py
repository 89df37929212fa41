import numpy as np
import PyOpenColorIO as OCIO
import pytest

from crfnet.configs.plate_color_space import PlateColorSpace
from crfnet.configs.portable import portable_config
from crfnet.errors import ConfigError
from tests.helpers.configs import REC709_TO_AP1, SPACE, converted
from tests.helpers.refusals import refused


def test_it_is_valid_and_of_profile_2_0():
    config = portable_config([SPACE])
    config.validate()
    assert (config.getMajorVersion(), config.getMinorVersion()) == (2, 0)
    assert list(config.getSearchPaths()) == ["."]


@pytest.mark.parametrize("name", ["lin_rec709", "lin_rec709_scene", "Linear Rec.709 (sRGB)", "linear", "lin_srgb"])
def test_every_host_finds_its_name_of_scene_linear(name):
    assert portable_config([]).getColorSpace(name).getName() == "Linear Rec.709"


@pytest.mark.parametrize(
    ("source", "target", "pixel", "expected"),
    [
        ("sRGB", "scene_linear", [0.5, 0.5, 1], [0.21404114, 0.21404114, 1]),
        ("scene_linear", "ACES2065-1", [1, 1, 1], [1, 1, 1]),
        ("scene_linear", "ACES2065-1", [1, 0, 0], [0.43963298, 0.08977644, 0.01754117]),
        ("scene_linear", "ACEScg", [0, 1, 0], REC709_TO_AP1[:, 1]),
        ("scene_linear", "ACEScct", [0.18, 0.18, 0.18], [0.41358840, 0.41358840, 0.41358840]),
        ("scene_linear", "CIE-XYZ-D65", [1, 1, 1], [0.95045593, 1, 1.08905775]),
        ("scene_linear", "sRGB - Display", [0.21404114, 1, 0], [0.5, 1, 0]),
        ("scene_linear", "Rec.1886 Rec.709 - Display", [0.5**2.4, 1, 0], [0.5, 1, 0]),
        ("Non-Color", "scene_linear", [0.5, 2, -1], [0.5, 2, -1]),
    ],
)
def test_its_spaces_have_known_values(source, target, pixel, expected):
    np.testing.assert_allclose(converted(portable_config([]), source, target, [pixel]), [expected], atol=3e-6)


@pytest.mark.parametrize("display", ["sRGB", "Rec.709"])
def test_its_displays_show_white_as_white(display):
    transform = OCIO.DisplayViewTransform(src="scene_linear", display=display, view="Standard")
    processor = portable_config([]).getProcessor(transform)
    result = processor.getOptimizedCPUProcessor(OCIO.OPTIMIZATION_LOSSLESS).applyRGB([1.0, 1.0, 1.0])
    np.testing.assert_allclose(result, 1, atol=3e-6)
    assert list(portable_config([]).getViews(display)) == ["Standard", "Raw"]


@pytest.mark.parametrize(
    ("path", "space"),
    [
        ("shot_plate01.0001.png", "CRF plate01"),
        ("/a/shot_plate01x0001xpng", "Non-Color"),
        *(("a.PNG", "sRGB"), ("a.jpeg", "sRGB"), ("a.exr", "scene_linear"), ("a.EXR", "scene_linear")),
        ("a.dpx", "Non-Color"),
    ],
)
def test_files_find_their_space_by_rules(path, space):
    plate = PlateColorSpace("CRF plate01", "plate01.spi1d", file_patterns=("shot_plate01.????.png",))
    assert portable_config([plate]).getColorSpaceFromFilepath(path)[0] == space


def test_an_alias_that_is_taken_is_left_out():
    spaces = [PlateColorSpace(f"CRF {name}", f"{name}.spi1d", aliases=("same",)) for name in "ab"]
    config = portable_config([*spaces, PlateColorSpace("CRF c", "c.spi1d", aliases=("lin_rec709", "crf_c"))])
    assert [list(config.getColorSpace(f"CRF {name}").getAliases()) for name in "abc"] == [["same"], [], ["crf_c"]]


@pytest.mark.parametrize("name", ["sRGB", "lin_rec709", "scene_linear", "crf PLATE01"])
def test_names_that_are_taken_are_refused(name):
    with refused(ConfigError, "color_space_exists"):
        portable_config([SPACE, PlateColorSpace(name, "a.spi1d")])


def test_hosts_find_plates_and_files_by_their_category():
    assert all("file-io" in space.getCategories() for space in portable_config([]).getColorSpaces())
