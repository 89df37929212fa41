"""A config is written only if OpenColorIO converts as its LUTs do; the real tools read it."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import PyOpenColorIO as OCIO
import pytest

from crfnet.configs.files import MAX_CONFIG_SIZE, load_config, role_name, write_config
from crfnet.configs.plate_color_space import PlateColorSpace
from crfnet.configs.portable import portable_config
from crfnet.errors import ConfigError
from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import Lut1D, inverse_response_lut
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.configs import LUT, SPACE, converted, loaded
from tests.helpers.folders import listed
from tests.helpers.images import read_image, write_image


@pytest.fixture
def folder(tmp_path):
    """A folder with the plate's LUT."""
    write_lut(tmp_path / "plate01.spi1d", LUT)
    return tmp_path


class TestWriting:
    @pytest.mark.parametrize("suffix", [".spi1d", ".cube", ".clf"])
    @pytest.mark.parametrize("exposure", [0, 1.5, -3])
    def test_the_written_config_converts_as_the_lut(self, tmp_path, suffix, exposure, tolerance):
        write_lut(tmp_path / f"a{suffix}", LUT)
        config = portable_config([PlateColorSpace("CRF a", f"a{suffix}", exposure=exposure)])
        write_config(tmp_path / "config.ocio", config, check={"CRF a": LUT})
        written = loaded(tmp_path / "config.ocio")
        values = np.linspace(-0.1, 1.1, 999, dtype=np.float32).reshape(-1, 3)
        linear = converted(written, "CRF a", "scene_linear", values)
        np.testing.assert_allclose(linear, LUT.apply(values) * 2.0**exposure, atol=tolerance.plate)
        back = converted(written, "scene_linear", "CRF a", linear)
        np.testing.assert_allclose(LUT.apply(back), LUT.apply(values), atol=tolerance.plate)

    def test_the_folder_can_be_moved(self, folder, tmp_path_factory):
        write_config(folder / "config.ocio", portable_config([SPACE]), check={"CRF plate01": LUT})
        moved = Path(shutil.move(folder, tmp_path_factory.mktemp("moved") / "elsewhere"))
        found = converted(loaded(moved / "config.ocio"), "CRF plate01", "scene_linear", [[0.5, 1, 1.125]])
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
        assert loaded(path).getColorSpace("CRF plate01") is not None

    def test_a_lut_that_changed_since_is_read_again(self, folder):
        write_config(folder / "a.ocio", portable_config([SPACE]), check={"CRF plate01": LUT})
        other = inverse_response_lut(ResponseCurve.gamma(1.8))
        write_lut(folder / "plate01.spi1d", other, overwrite=True)
        write_config(folder / "b.ocio", portable_config([SPACE]), check={"CRF plate01": other})

    @pytest.mark.parametrize(
        ("check", "code"),
        [
            ({"CRF plate01": inverse_response_lut(ResponseCurve.gamma(2.0))}, "config_differs_from_lut"),
            ({"CRF plate01": Lut1D(LUT.values[:-1], LUT.domain)}, "config_differs_from_lut"),
            ({"CRF plate02": LUT}, "color_space_absent"),
        ],
    )
    def test_a_config_that_converts_otherwise_is_not_written(self, folder, check, code):
        with pytest.raises(ConfigError) as caught:
            write_config(folder / "config.ocio", portable_config([SPACE]), check=check)
        assert caught.value.code == code
        assert listed(folder) == ["plate01.spi1d"]

    def test_a_config_without_its_lut_is_not_written(self, tmp_path):
        with pytest.raises(ConfigError, match=r"plate01\.spi1d") as caught:
            write_config(tmp_path / "config.ocio", portable_config([SPACE]), check={"CRF plate01": LUT})
        assert caught.value.code == "config_invalid"
        assert "\n" not in str(caught.value)
        assert list(tmp_path.iterdir()) == []

    def test_a_config_that_is_not_valid_is_not_written(self, folder):
        config = portable_config([SPACE])
        config.setRole("color_picking", "no such space")
        with pytest.raises(ConfigError) as caught:
            write_config(folder / "config.ocio", config, check={"CRF plate01": LUT})
        assert caught.value.code == "config_invalid"
        assert listed(folder) == ["plate01.spi1d"]


class TestLoading:
    def test_a_role_has_a_name(self, folder):
        write_config(folder / "config.ocio", portable_config([SPACE]), check={"CRF plate01": LUT})
        assert load_config(folder / "config.ocio").getColorSpace("CRF plate01") is not None
        assert role_name(folder / "config.ocio", OCIO.ROLE_SCENE_LINEAR) == "Linear Rec.709"

    def test_a_role_that_is_not_there_is_refused(self, folder):
        write_config(folder / "config.ocio", portable_config([SPACE]), check={"CRF plate01": LUT})
        with pytest.raises(ConfigError) as caught:
            role_name(folder / "config.ocio", "nonsense")
        assert caught.value.code == "role_absent"

    def test_a_config_that_is_not_there_is_named(self, tmp_path):
        with pytest.raises(ConfigError) as caught:
            load_config(tmp_path / "config.ocio")
        assert caught.value.code == "config_absent"

    @pytest.mark.parametrize("text", ["", "no config"])
    def test_what_is_no_config_is_refused(self, tmp_path, text):
        (tmp_path / "config.ocio").write_text(text)
        with pytest.raises(ConfigError) as caught:
            load_config(tmp_path / "config.ocio")
        assert caught.value.code == "config_refused"
        assert "\n" not in str(caught.value)

    @pytest.mark.parametrize("depth", [3, 9])
    def test_nested_aliases_are_refused_before_they_multiply(self, tmp_path, depth):
        """Nine levels of nine make a kilobyte take gigabytes."""
        lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
        lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, depth + 1)]
        (tmp_path / "config.ocio").write_text("\n".join([*lines, portable_config([]).serialize()]))
        with pytest.raises(ConfigError) as caught:
            load_config(tmp_path / "config.ocio")
        assert caught.value.code == "config_aliases"

    def test_a_few_aliases_and_stars_in_texts_are_none(self, tmp_path):
        text = portable_config([]).serialize().replace("name: crfnet", "name: &title crfnet")
        text = text.replace("description: Camera", "description: 2 * 3 * x, a*b*c *.exr Camera", 1)
        (tmp_path / "config.ocio").write_text(text.replace("family: Data", "family: *title"))
        assert load_config(tmp_path / "config.ocio").getColorSpace("Non-Color").getFamily() == "crfnet"

    def test_a_config_of_many_megabytes_is_refused(self, tmp_path):
        with (tmp_path / "config.ocio").open("wb") as file:
            file.truncate(MAX_CONFIG_SIZE + 1)
        with pytest.raises(ConfigError) as caught:
            load_config(tmp_path / "config.ocio")
        assert caught.value.code == "config_unreadable"


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


class TestTools:
    @pytest.fixture(scope="class")
    @classmethod
    def shot(cls, tmp_path_factory):
        """A folder with a float plate, its LUTs and its config; and the plate's pixels."""
        folder = tmp_path_factory.mktemp("shot")
        for suffix in (".spi1d", ".cube", ".clf"):
            write_lut(folder / f"plate01{suffix}", LUT)
        plate = PlateColorSpace("CRF plate01", "plate01.spi1d", file_patterns=("shot_plate01.*.exr",))
        write_config(folder / "config.ocio", portable_config([plate]), check={"CRF plate01": LUT})
        pixels = np.random.default_rng(0).uniform(-0.1, 1.1, (32, 48, 3)).astype(np.float32)
        write_image(folder / "shot_plate01.0001.exr", pixels)
        return folder, pixels

    @pytest.mark.parametrize("suffix", [".spi1d", ".cube", ".clf"])
    def test_oiiotool_applies_the_lut_and_its_inverse(self, shot, tmp_path, suffix, tolerance):
        folder, pixels = shot
        plate, linear, back = folder / "shot_plate01.0001.exr", tmp_path / "linear.exr", tmp_path / "back.exr"
        lut = folder / f"plate01{suffix}"
        run(tool("oiiotool"), plate, "--ociofiletransform", lut, "-d", "float", "-o", linear)
        assert np.abs(read_image(linear) - LUT.apply(pixels)).max() < tolerance.plate
        run(tool("oiiotool"), linear, "--ociofiletransform:inverse=1", lut, "-d", "float", "-o", back)
        assert np.abs(LUT.apply(read_image(back)) - LUT.apply(pixels)).max() < tolerance.plate

    def test_oiiotool_converts_with_the_config(self, shot, tmp_path, tolerance):
        folder, pixels = shot
        start = (tool("oiiotool"), "--colorconfig", folder / "config.ocio", folder / "shot_plate01.0001.exr")
        run(*start, "--colorconvert", "CRF plate01", "scene_linear", "-d", "float", "-o", tmp_path / "linear.exr")
        assert np.abs(read_image(tmp_path / "linear.exr") - LUT.apply(pixels)).max() < tolerance.plate

    def test_oiiotool_converts_by_the_file_rule(self, shot, tmp_path, tolerance):
        folder, pixels = shot
        start = (tool("oiiotool"), "--colorconfig", folder / "config.ocio", "--autocc")
        run(*start, folder / "shot_plate01.0001.exr", "-d", "float", "-o", tmp_path / "linear.exr")
        assert np.abs(read_image(tmp_path / "linear.exr") - LUT.apply(pixels)).max() < tolerance.plate

    def test_ociocheck_passes(self, shot):
        report = run(tool("ociocheck"), "--iconfig", shot[0] / "config.ocio")
        assert "Validation: passed" in report
        assert "Warnings encountered" not in report
