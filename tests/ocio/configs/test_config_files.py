"""A config is written only if OpenColorIO converts as its LUTs do; the real tools read it."""

import os
import shutil
import subprocess
import sys
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import PyOpenColorIO as OCIO
import pytest

from crfnet.configs.files import MAX_CONFIG_SIZE, MOST_SPACES, load_config, write_config
from crfnet.configs.plate_color_space import PlateColorSpace
from crfnet.configs.portable import portable_config
from crfnet.errors import ConfigError
from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import Lut1D, inverse_response_lut
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.configs import LUT, SPACE, converted, loaded
from tests.helpers.folders import listed, written
from tests.helpers.refusals import refusal_of, refused

PORTABLE = portable_config([]).serialize()


def aliases(depth):
    """A config behind lists of nine aliases each, which name one another."""
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, depth + 1)]
    return "\n".join([*lines, PORTABLE])


def variables(values):
    """A config that declares variables."""
    declared = ", ".join(f'{name}: "{value}"' for name, value in values.items())
    return PORTABLE.replace("environment:\n  {}", f"environment: {{{declared}}}").encode()


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

    def test_it_is_replaced_only_when_asked(self, folder):
        path = written(folder / "config.ocio", "mine")
        with refused(ConfigError, "exists"):
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
        with refused(ConfigError, code):
            write_config(folder / "config.ocio", portable_config([SPACE]), check=check)
        assert listed(folder) == ["plate01.spi1d"]

    def test_a_config_without_its_lut_is_not_written(self, tmp_path):
        with refused(ConfigError, "config_invalid"):
            write_config(tmp_path / "config.ocio", portable_config([SPACE]), check={"CRF plate01": LUT})
        assert list(tmp_path.iterdir()) == []


class TestLoading:
    @pytest.mark.parametrize("direction", ["toReference", "fromReference"])
    def test_a_lut_that_is_a_device_is_refused(self, folder, direction):
        """OpenColorIO would read a device without end, and wait for the writer of a pipe."""
        path = folder / "config.ocio"
        for source in ("absent.spi1d", os.devnull):
            config = portable_config([SPACE])
            steps = OCIO.GroupTransform([OCIO.FileTransform(source)])
            config.addColorSpace(OCIO.ColorSpace(name="lut", **{direction: steps}))
            written(path, config.serialize())
            with refused(ConfigError, "config_reads_device") if source == os.devnull else nullcontext():
                load_config(path)

    @pytest.mark.parametrize(
        ("content", "code"),
        [
            *((content, "config_refused") for content in (b"", b"no config")),
            (bytes(MAX_CONFIG_SIZE + 1), "config_unreadable"),
            (PORTABLE.replace("name: crfnet", "name: Voigtl\u00e4nder").encode("latin-1"), "config_unreadable"),
            *((aliases(3).encode(), "config_too_many"), (aliases(9).encode(), "config_too_many")),
            (aliases(9).encode("utf-16-le"), "config_too_many"),
            (PORTABLE.encode() + b"\n  - !<ColorSpace>\n    name: x" * MOST_SPACES, "config_too_many"),
            (variables({f"k{n:02}": f"$k{n + 1:02}%k{n + 1:02}%" for n in range(40)}), "config_variables"),
            (variables({"A": "$B$B", "B": "${A}${A}"}), "config_variables"),
            (variables({"D": "$"} | {f"k{n:02}": f"${{D}}k{n + 1:02}" * 2 for n in range(40)}), "config_variables"),
            (variables({f"k{n}": "x" for n in range(101)}), "config_variables"),
        ],
        ids=lambda value: value if isinstance(value, str) else "",
    )
    def test_a_file_that_is_no_config_or_not_utf8_or_too_large_or_multiplies_is_refused(self, tmp_path, content, code):
        """Aliases and variables before they do: nine levels of nine make a kilobyte take gigabytes."""
        assert refusal_of(ConfigError, load_config, written(tmp_path / "config.ocio", content)).code == code

    def test_a_few_aliases_and_stars_in_texts_are_accepted(self, tmp_path):
        text = PORTABLE.replace("name: crfnet", "name: &title crfnet")
        text = "# ***\n" * 9 + text.replace("description: Camera", "description: 2 * 3 * x *.exr Camera", 1)
        path = written(tmp_path / "config.ocio", text.replace("family: Data", "family: *title"))
        assert load_config(path).getColorSpace("Non-Color").getFamily() == "crfnet"

    def test_variables_of_variables_are_accepted(self, tmp_path):
        declared = 'environment: {SHOW: a, ROOT: /shows/$SHOW, SHOT: s1, SHOT_ROOT: "$ROOT/${SHOT}", LOOP: $LOOP}'
        path = written(tmp_path / "config.ocio", PORTABLE.replace("environment:\n  {}", declared))
        assert len(list(load_config(path).getEnvironmentVarNames())) == 5


def test_ociocheck_passes(folder):
    command = shutil.which("ociocheck", path=str(Path(sys.executable).parent)) or shutil.which("ociocheck")
    if command is None:
        pytest.skip("needs ociocheck")
    write_config(folder / "config.ocio", portable_config([SPACE]), check={"CRF plate01": LUT})
    done = subprocess.run([command, "--iconfig", folder / "config.ocio"], capture_output=True, text=True, check=True)
    assert "Validation: passed" in done.stdout
    assert "Warnings encountered" not in done.stdout
