import copy

import numpy as np
import PyOpenColorIO as OCIO
import pytest

from crfnet.configs.files import write_config
from crfnet.configs.plate_color_space import PlateColorSpace, add_plate_color_spaces
from crfnet.configs.portable import portable_config
from crfnet.errors import ConfigError
from crfnet_core.colorimetry import DISPLAY_P3
from tests.helpers.configs import LUT, REC709_TO_AP1, SPACE, converted, loaded
from tests.helpers.refusals import refusal_of, refused


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
    plate = PlateColorSpace("CRF plate01", "plate01.spi1d", file_patterns=("shot_plate01.#.png",))
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


BUILT_IN = ("cg-config-v1.0.0_aces-v1.3_ocio-v2.1", "studio-config-v2.1.0_aces-v1.3_ocio-v2.3")

SMALL = """\
ocio_profile_version: {version}
search_path: luts
strictparsing: true
roles:
  scene_linear: working
  default: raw
  {roles}
displays:
  monitor:
    - !<View> {{name: Raw, colorspace: raw}}
colorspaces:
  - !<ColorSpace>
    name: working
  - !<ColorSpace>
    name: raw
    isdata: true
"""


def small_config(version="2", roles="data: raw"):
    return OCIO.Config.CreateFromStream(SMALL.format(version=version, roles=roles))


def added(config, *spaces):
    """A copy of a config with plates, which finds their LUTs in its folder."""
    config = copy.deepcopy(config)
    config.addSearchPath(".")
    add_plate_color_spaces(config, spaces)
    return config


@pytest.mark.parametrize(
    ("name", "lut_file", "exposure", "code"),
    [
        ("  ", "a.spi1d", 0, "nameless_color_space"),
        *(("CRF", name, 0, "lut_outside_config_folder") for name in ("", "/tmp/a.spi1d", "C:a.spi1d", "../a.spi1d")),
        *(("CRF", name, 0, "lut_name_is_variable") for name in ("a$b.spi1d", "a%b.spi1d")),
        ("CRF", "a.spi1d", np.inf, "exposure_not_finite"),
    ],
)
def test_a_space_that_no_config_can_have_is_refused(name, lut_file, exposure, code):
    assert refusal_of(ConfigError, PlateColorSpace, name, lut_file, exposure=exposure).code == code


class TestAdding:
    def test_a_config_without_rec709_goes_by_aces_interchange(self, folder):
        config = added(small_config(roles="aces_interchange: working"), SPACE)
        write_config(folder / "config.ocio", config, check={"CRF plate01": LUT})
        result = converted(loaded(folder / "config.ocio"), "CRF plate01", "working", [[1, 1, 1], [1, 0, 0]])
        np.testing.assert_allclose(result, [[1, 1, 1], [0.43963298, 0.08977644, 0.01754117]], atol=1e-6)

    def test_a_config_without_any_way_from_rec709_is_refused(self):
        assert refusal_of(ConfigError, added, small_config(), SPACE).code == "config_without_rec709"


class TestPrimaries:
    PLATE = PlateColorSpace("CRF plate01", "plate01.spi1d", primaries=DISPLAY_P3, exposure=0.5)

    @pytest.mark.parametrize("base", [*BUILT_IN, "studio-config-latest"])
    def test_they_reach_aces_as_the_config_itself_converts_them(self, folder, base):
        config = added(OCIO.Config.CreateFromBuiltinConfig(base), self.PLATE)
        write_config(folder / "config.ocio", config, check={"CRF plate01": LUT})
        pixels = np.random.default_rng(0).uniform(0, 1, (500, 3)).astype(np.float32)
        result = converted(loaded(folder / "config.ocio"), "CRF plate01", "ACES2065-1", pixels)
        base_config = OCIO.Config.CreateFromBuiltinConfig("studio-config-latest")
        light = LUT.apply(pixels).astype(np.float32) * 2**0.5
        expected = converted(base_config, "lin_p3d65_scene", "ACES2065-1", light)
        np.testing.assert_allclose(result, expected, atol=1e-5)

    @pytest.mark.parametrize("name", ["lin_p3d65_scene", "lin_adobergb_scene", "lin_rec2020_scene"])
    @pytest.mark.parametrize("target", ["ACES2065-1", "ACEScg", "lin_rec709_scene"])
    def test_linear_spaces_are_those_of_the_studio_config(self, name, target):
        pixels = np.random.default_rng(0).uniform(-0.1, 2, (500, 3)).astype(np.float32)
        expected = converted(OCIO.Config.CreateFromBuiltinConfig("studio-config-latest"), name, target, pixels)
        np.testing.assert_allclose(converted(portable_config([]), name, target, pixels), expected, atol=1e-5)
