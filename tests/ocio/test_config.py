"""OpenColorIO configs that know a plate's colour space."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import PyOpenColorIO as OCIO
import pytest

from crfnet_core.errors import ConfigError
from crfnet_core.response import ResponseCurve
from ocio.configs.files import write_config
from ocio.configs.plate_color_space import FAMILY, PlateColorSpace, add_plate_color_space
from ocio.configs.portable import portable_config
from ocio.luts.files import write_lut
from ocio.luts.lut1d import Lut1D, inverse_response_lut

SPACE = PlateColorSpace("CRF plate01", "plate01.spi1d", aliases=("crf_plate01",), description="from a.jpg")
LUT = inverse_response_lut(ResponseCurve.gamma(2.2), length=5101, domain=(-0.125, 1.125))
BUILT_IN = ("cg-config-v1.0.0_aces-v1.3_ocio-v2.1", "studio-config-v2.1.0_aces-v1.3_ocio-v2.3")

#: Linear Rec.709 to ACEScg, as published by colour-science and others.
REC709_TO_AP1 = np.array(
    [[0.6130974, 0.3395231, 0.0473795], [0.0701937, 0.9163539, 0.0134524], [0.0206156, 0.1095698, 0.8698147]]
)

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


def converted(config, source, target, pixels):
    """Pixels, shape (N, 3), through OpenColorIO's CPU processor."""
    pixels = np.array(pixels, dtype=np.float32)
    processor = config.getProcessor(source, target)
    processor.getOptimizedCPUProcessor(OCIO.OPTIMIZATION_LOSSLESS).applyRGB(pixels)
    return pixels


def rule_names(config):
    rules = config.getFileRules()
    return [rules.getName(index) for index in range(rules.getNumEntries())]


@pytest.fixture
def folder(tmp_path):
    """A folder with the plate's LUT."""
    write_lut(tmp_path / "plate01.spi1d", LUT)
    return tmp_path


class TestPlateColorSpace:
    @pytest.mark.parametrize("name", ["", "  "])
    def test_a_name_is_needed(self, name):
        with pytest.raises(ConfigError, match="needs a name"):
            PlateColorSpace(name, "a.spi1d")

    @pytest.mark.parametrize(
        "lut_file", ["", ".", "/tmp/a.spi1d", "C:\\a.spi1d", "C:a.spi1d", "\\\\s\\d\\a", "../a.spi1d"]
    )
    def test_the_lut_lies_in_the_folder(self, lut_file):
        with pytest.raises(ConfigError, match="put the LUT beside the config"):
            PlateColorSpace("CRF", lut_file)

    @pytest.mark.parametrize("lut_file", ["a$b.spi1d", "a%b.spi1d"])
    def test_the_lut_is_no_variable(self, lut_file):
        with pytest.raises(ConfigError, match="for variables"):
            PlateColorSpace("CRF", lut_file)

    @pytest.mark.parametrize("exposure", [np.nan, np.inf])
    def test_the_exposure_is_a_number(self, exposure):
        with pytest.raises(ConfigError, match="must be a number of stops"):
            PlateColorSpace("CRF", "a.spi1d", exposure=exposure)


class TestPortableConfig:
    def test_it_is_valid_and_of_profile_2_0(self):
        config = portable_config([SPACE])
        config.validate()
        assert (config.getMajorVersion(), config.getMinorVersion()) == (2, 0)
        assert list(config.getSearchPaths()) == ["."]

    def test_the_roles_are_complete(self):
        assert dict(portable_config([]).getRoles()) == {
            "aces_interchange": "ACES2065-1",
            "cie_xyz_d65_interchange": "CIE-XYZ-D65",
            "color_picking": "sRGB",
            "color_timing": "ACEScct",
            "compositing_log": "ACEScct",
            "data": "Non-Color",
            "default_byte": "sRGB",
            "default_float": "Linear Rec.709",
            "default_sequencer": "sRGB",
            "matte_paint": "sRGB",
            "reference": "Linear Rec.709",
            "rendering": "Linear Rec.709",
            "scene_linear": "Linear Rec.709",
            "texture_paint": "sRGB",
        }

    @pytest.mark.parametrize("name", ["lin_rec709", "lin_rec709_scene", "Linear Rec.709 (sRGB)", "linear", "lin_srgb"])
    def test_every_host_finds_its_name_of_scene_linear(self, name):
        assert portable_config([]).getColorSpace(name).getName() == "Linear Rec.709"

    def test_the_plates_space_says_what_it_is(self):
        space = portable_config([SPACE]).getColorSpace("crf_plate01")
        assert space.getName() == "CRF plate01"
        assert space.getFamily() == FAMILY == "Camera Response"
        assert space.getEncoding() == "sdr-video"
        assert space.getDescription() == "from a.jpg"
        assert not space.isData()

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
    def test_its_spaces_have_known_values(self, source, target, pixel, expected):
        found = converted(portable_config([]), source, target, [pixel])
        np.testing.assert_allclose(found, [expected], atol=3e-6)

    @pytest.mark.parametrize("display", ["sRGB", "Rec.709"])
    def test_its_displays_show_white_as_white(self, display):
        transform = OCIO.DisplayViewTransform(src="scene_linear", display=display, view="Standard")
        processor = portable_config([]).getProcessor(transform)
        found = processor.getOptimizedCPUProcessor(OCIO.OPTIMIZATION_LOSSLESS).applyRGB([1.0, 1.0, 1.0])
        np.testing.assert_allclose(found, 1, atol=3e-6)
        assert list(portable_config([]).getViews(display)) == ["Standard", "Raw"]

    @pytest.mark.parametrize(
        ("path", "space"),
        [
            ("shot_plate01.0001.png", "CRF plate01"),
            ("/a b/shot_plate01.0001.png", "CRF plate01"),
            ("C:\\a\\shot_plate01.0001.png", "CRF plate01"),
            ("/a/xshot_plate01.0001.png", "sRGB"),
            ("/a/shot_plate01.0001.jpg", "sRGB"),
            ("/shot_plate01.1/beauty.png", "sRGB"),
            ("/a/shot_plate01x0001xpng", "Non-Color"),
            ("a.PNG", "sRGB"),
            ("a.jpeg", "sRGB"),
            ("a.exr", "scene_linear"),
            ("a.EXR", "scene_linear"),
            ("a.dpx", "Non-Color"),
        ],
    )
    def test_files_find_their_space_by_rules(self, path, space):
        plate = PlateColorSpace("CRF plate01", "plate01.spi1d", file_pattern="shot_plate01.????.png")
        assert portable_config([plate]).getColorSpaceFromFilepath(path)[0] == space

    def test_patterns_are_no_regular_expressions(self):
        plate = PlateColorSpace("CRF", "a.spi1d", file_pattern="a+(b)[1]*.png")
        config = portable_config([plate])
        assert config.getColorSpaceFromFilepath("a+(b)[1]_2.png")[0] == "CRF"
        assert config.getColorSpaceFromFilepath("aab1.png")[0] == "sRGB"

    def test_several_plates(self):
        plates = [PlateColorSpace(f"CRF {name}", f"{name}.spi1d", file_pattern=f"{name}.*") for name in "abc"]
        config = portable_config(plates)
        config.validate()
        assert rule_names(config)[:3] == ["CRF c", "CRF b", "CRF a"]
        assert config.getColorSpaceFromFilepath("/x/b.tif")[0] == "CRF b"

    def test_two_plates_of_one_name_are_refused(self):
        with pytest.raises(ConfigError, match="two plates have this name"):
            portable_config([SPACE, PlateColorSpace("crf PLATE01", "other.spi1d")])

    def test_two_plates_of_one_alias_are_refused(self):
        with pytest.raises(ConfigError, match=r"CRF b: cannot be added to the config \(.*alias"):
            portable_config([PlateColorSpace(f"CRF {name}", "a.spi1d", aliases=("same",)) for name in "ab"])

    @pytest.mark.parametrize("name", ["sRGB", "lin_rec709", "scene_linear"])
    def test_names_of_the_config_are_refused(self, name):
        with pytest.raises(ConfigError, match="choose another name"):
            portable_config([PlateColorSpace(name, "a.spi1d")])

    def test_the_text_is_reproducible(self):
        assert portable_config([SPACE]).serialize() == portable_config([SPACE]).serialize()


class TestAdding:
    @pytest.mark.parametrize("base", BUILT_IN)
    def test_the_base_keeps_everything_and_is_not_changed(self, base):
        config = OCIO.Config.CreateFromBuiltinConfig(base)
        before = config.serialize()
        plate = PlateColorSpace("CRF plate01", "plate01.spi1d", file_pattern="shot.*")
        found = add_plate_color_space(config, plate)
        assert config.serialize() == before
        assert found.getMinorVersion() == config.getMinorVersion()
        assert rule_names(found) == ["CRF plate01", *rule_names(config)]
        assert list(found.getColorSpaceNames()) == [*config.getColorSpaceNames(), "CRF plate01"]
        assert dict(found.getRoles()) == dict(config.getRoles())
        assert list(found.getSearchPaths()) == ["."]

    @pytest.mark.parametrize("base", BUILT_IN)
    def test_the_plate_is_converted_from_rec709_to_aces(self, folder, base):
        config = add_plate_color_space(OCIO.Config.CreateFromBuiltinConfig(base), SPACE)
        write_config(folder / "config.ocio", config, check={"CRF plate01": LUT})
        loaded = OCIO.Config.CreateFromFile(str(folder / "config.ocio"))
        pixels = np.random.default_rng(0).uniform(-0.1, 1.1, (500, 3)).astype(np.float32)
        expected = LUT.apply(pixels) @ REC709_TO_AP1.T
        np.testing.assert_allclose(converted(loaded, "CRF plate01", "ACEScg", pixels), expected, atol=1e-5)
        back = converted(loaded, "ACEScg", "CRF plate01", expected)
        np.testing.assert_allclose(LUT.apply(back), LUT.apply(pixels), atol=1e-4)

    def test_a_config_without_rec709_goes_by_aces_interchange(self, folder):
        config = add_plate_color_space(small_config(roles="aces_interchange: working"), SPACE)
        write_config(folder / "config.ocio", config, check={"CRF plate01": LUT})
        loaded = OCIO.Config.CreateFromFile(str(folder / "config.ocio"))
        assert list(loaded.getSearchPaths()) == ["luts", "."]
        found = converted(loaded, "CRF plate01", "working", [[1, 1, 1], [1, 0, 0]])
        np.testing.assert_allclose(found, [[1, 1, 1], [0.43963298, 0.08977644, 0.01754117]], atol=1e-6)

    def test_a_config_without_any_way_from_rec709_is_refused(self):
        with pytest.raises(ConfigError, match="neither a space 'lin_rec709_scene' nor a role aces_interchange"):
            add_plate_color_space(small_config(), SPACE)

    def test_a_config_of_profile_1_gets_no_aliases_and_no_rules(self):
        plate = PlateColorSpace("CRF plate01", "a.spi1d", aliases=("crf_plate01",), file_pattern="a.*")
        found = add_plate_color_space(small_config(version="1", roles="aces_interchange: working"), plate)
        found.validate()
        assert found.getMajorVersion() == 1
        assert found.getColorSpace("CRF plate01") is not None
        assert found.getColorSpace("crf_plate01") is None

    def test_our_own_space_is_replaced(self):
        config = portable_config([PlateColorSpace("CRF a", "old.spi1d", ("crf_a",), file_pattern="old.*")])
        found = add_plate_color_space(config, PlateColorSpace("CRF a", "new.spi1d", ("crf_a",), file_pattern="new.*"))
        found.validate()
        assert rule_names(found).count("CRF a") == 1
        assert found.getColorSpaceFromFilepath("new.png")[0] == "CRF a"
        assert "old.spi1d" not in found.serialize()

    def test_without_a_new_pattern_the_old_rule_goes(self):
        config = portable_config([PlateColorSpace("CRF a", "a.spi1d", file_pattern="old.*")])
        assert "CRF a" not in rule_names(add_plate_color_space(config, PlateColorSpace("CRF a", "a.spi1d")))

    def test_an_alias_of_our_own_space_is_refused(self):
        with pytest.raises(ConfigError, match="uses this name for 'CRF plate01'"):
            add_plate_color_space(portable_config([SPACE]), PlateColorSpace("crf_plate01", "a.spi1d"))


class TestWriting:
    @pytest.mark.parametrize("suffix", [".spi1d", ".cube", ".clf"])
    @pytest.mark.parametrize("exposure", [0, 1.5, -3])
    def test_the_written_config_converts_as_the_lut(self, tmp_path, suffix, exposure, tolerance):
        write_lut(tmp_path / f"a{suffix}", LUT)
        config = portable_config([PlateColorSpace("CRF a", f"a{suffix}", exposure=exposure)])
        write_config(tmp_path / "config.ocio", config, check={"CRF a": LUT})
        loaded = OCIO.Config.CreateFromFile(str(tmp_path / "config.ocio"))
        values = np.linspace(-0.1, 1.1, 999, dtype=np.float32).reshape(-1, 3)
        linear = converted(loaded, "CRF a", "scene_linear", values)
        np.testing.assert_allclose(linear, LUT.apply(values) * 2.0**exposure, atol=tolerance.plate)
        back = converted(loaded, "scene_linear", "CRF a", linear)
        np.testing.assert_allclose(LUT.apply(back), LUT.apply(values), atol=tolerance.plate)

    def test_the_folder_can_be_moved(self, folder, tmp_path_factory):
        write_config(folder / "config.ocio", portable_config([SPACE]), check={"CRF plate01": LUT})
        moved = Path(shutil.move(folder, tmp_path_factory.mktemp("moved") / "elsewhere"))
        OCIO.ClearAllCaches()
        loaded = OCIO.Config.CreateFromFile(str(moved / "config.ocio"))
        found = converted(loaded, "CRF plate01", "scene_linear", [[0.5, 1, 1.125]])
        np.testing.assert_allclose(found[0], LUT.apply(np.float32([0.5, 1, 1.125])), atol=1e-6)

    def test_the_same_config_gives_the_same_bytes(self, folder):
        for name in ("a.ocio", "b.ocio"):
            write_config(folder / name, portable_config([SPACE]), check={"CRF plate01": LUT})
        assert (folder / "a.ocio").read_bytes() == (folder / "b.ocio").read_bytes()

    def test_it_is_replaced_only_when_asked(self, folder):
        path = folder / "config.ocio"
        path.write_text("mine")
        with pytest.raises(ConfigError, match="exists already"):
            write_config(path, portable_config([SPACE]), check={"CRF plate01": LUT})
        assert path.read_text() == "mine"
        write_config(path, portable_config([SPACE]), check={"CRF plate01": LUT}, overwrite=True)
        assert OCIO.Config.CreateFromFile(str(path)).getColorSpace("CRF plate01") is not None

    def test_a_lut_that_changed_since_is_read_again(self, folder):
        write_config(folder / "a.ocio", portable_config([SPACE]), check={"CRF plate01": LUT})
        other = inverse_response_lut(ResponseCurve.gamma(1.8))
        write_lut(folder / "plate01.spi1d", other, overwrite=True)
        write_config(folder / "b.ocio", portable_config([SPACE]), check={"CRF plate01": other})

    @pytest.mark.parametrize(
        ("check", "message"),
        [
            ({"CRF plate01": inverse_response_lut(ResponseCurve.gamma(2.0))}, "converts other than its LUT by 0.27;"),
            ({"CRF plate01": Lut1D(LUT.values[:-1], LUT.domain)}, "converts other than its LUT"),
            ({"CRF plate02": LUT}, "CRF plate02: the config has no such colour space"),
        ],
    )
    def test_a_config_that_converts_otherwise_is_not_written(self, folder, check, message):
        with pytest.raises(ConfigError, match=message):
            write_config(folder / "config.ocio", portable_config([SPACE]), check=check)
        assert [path.name for path in folder.iterdir()] == ["plate01.spi1d"]

    def test_a_config_without_its_lut_is_not_written(self, tmp_path):
        with pytest.raises(ConfigError, match=r"not written, OpenColorIO refuses it \(.*plate01\.spi1d") as caught:
            write_config(tmp_path / "config.ocio", portable_config([SPACE]), check={"CRF plate01": LUT})
        assert "\n" not in str(caught.value)
        assert list(tmp_path.iterdir()) == []

    def test_a_config_that_is_not_valid_is_not_written(self, folder):
        config = portable_config([SPACE])
        config.setRole("color_picking", "no such space")
        with pytest.raises(ConfigError, match="not written, OpenColorIO refuses it"):
            write_config(folder / "config.ocio", config, check={"CRF plate01": LUT})
        assert [path.name for path in folder.iterdir()] == ["plate01.spi1d"]


def tool(name):
    """The path of a command that comes with our dependencies."""
    found = shutil.which(name, path=str(Path(sys.executable).parent)) or shutil.which(name)
    if found is None:
        pytest.skip(f"needs {name}")
    return found


def run(*command):
    environment = {key: value for key, value in os.environ.items() if key != "OCIO"}
    finished = subprocess.run(list(map(str, command)), env=environment, capture_output=True, text=True, check=False)
    assert finished.returncode == 0, finished.stdout + finished.stderr
    return finished.stdout


def read_pixels(path):
    return oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)


class TestTools:
    @pytest.fixture(scope="class")
    @classmethod
    def shot(cls, tmp_path_factory):
        """A folder with a float plate, its LUTs and its config; and the plate's pixels."""
        folder = tmp_path_factory.mktemp("shot")
        for suffix in (".spi1d", ".cube", ".clf"):
            write_lut(folder / f"plate01{suffix}", LUT)
        plate = PlateColorSpace("CRF plate01", "plate01.spi1d", file_pattern="shot_plate01.*.exr")
        write_config(folder / "config.ocio", portable_config([plate]), check={"CRF plate01": LUT})
        pixels = np.random.default_rng(0).uniform(-0.1, 1.1, (32, 48, 3)).astype(np.float32)
        buffer = oiio.ImageBuf(pixels)
        assert buffer.write(str(folder / "shot_plate01.0001.exr"))
        return folder, pixels

    @pytest.mark.parametrize("suffix", [".spi1d", ".cube", ".clf"])
    def test_oiiotool_applies_the_lut_and_its_inverse(self, shot, tmp_path, suffix, tolerance):
        folder, pixels = shot
        plate, linear, back = folder / "shot_plate01.0001.exr", tmp_path / "linear.exr", tmp_path / "back.exr"
        lut = folder / f"plate01{suffix}"
        run(tool("oiiotool"), plate, "--ociofiletransform", lut, "-d", "float", "-o", linear)
        assert np.abs(read_pixels(linear) - LUT.apply(pixels)).max() < tolerance.plate
        run(tool("oiiotool"), linear, "--ociofiletransform:inverse=1", lut, "-d", "float", "-o", back)
        assert np.abs(LUT.apply(read_pixels(back)) - LUT.apply(pixels)).max() < tolerance.plate

    def test_oiiotool_converts_with_the_config(self, shot, tmp_path, tolerance):
        folder, pixels = shot
        start = (tool("oiiotool"), "--colorconfig", folder / "config.ocio", folder / "shot_plate01.0001.exr")
        run(*start, "--colorconvert", "CRF plate01", "scene_linear", "-d", "float", "-o", tmp_path / "linear.exr")
        assert np.abs(read_pixels(tmp_path / "linear.exr") - LUT.apply(pixels)).max() < tolerance.plate

    def test_oiiotool_converts_by_the_file_rule(self, shot, tmp_path, tolerance):
        folder, pixels = shot
        start = (tool("oiiotool"), "--colorconfig", folder / "config.ocio", "--autocc")
        run(*start, folder / "shot_plate01.0001.exr", "-d", "float", "-o", tmp_path / "linear.exr")
        assert np.abs(read_pixels(tmp_path / "linear.exr") - LUT.apply(pixels)).max() < tolerance.plate

    def test_ociocheck_passes(self, shot):
        report = run(tool("ociocheck"), "--iconfig", shot[0] / "config.ocio")
        assert "Validation: passed" in report
        assert "Warnings encountered" not in report
