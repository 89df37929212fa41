"""The oiiotool lines that `crfnet estimate` prints make the plate that it writes, also of plates with alpha."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from crfnet_core.colorimetry import DISPLAY_P3, Primaries
from tests.helpers.color_profiles import matrix_profile, write_tagged
from tests.helpers.images import read_image, write_image

#: Primaries of no linear space in our config.
OWN = Primaries("own", (0.65, 0.33), (0.30, 0.60), (0.15, 0.07))


@pytest.fixture
def covered(codes):
    """Code values of the bundled photograph with alpha from 0 to 255."""
    alpha = np.tile(np.arange(codes.shape[1]) * 255 // (codes.shape[1] - 1), (codes.shape[0], 1))
    return np.dstack([codes, alpha.astype(np.uint8)])


@pytest.fixture
def printed(crfnet, fixed_model, tmp_path, monkeypatch, tolerance):
    """Run `crfnet estimate`, return what it prints last, and whether its two oiiotool lines make the linear plate."""
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.chdir(tmp_path)

    def run(photo, *options):
        options = (*options, "--out", tmp_path / "out", "--model", fixed_model, "--no-sheet")
        lines = [line.strip() for line in crfnet("estimate", *options, "--", photo).out.splitlines()]
        lines = lines[lines.index("The linear plate in oiiotool, with the LUT or the config:") + 1 :]
        (expected,) = map(read_image, (tmp_path / "out").glob("*_linear.exr"))
        are_right = []
        for line in lines[:2]:
            subprocess.run(line, shell=True, check=True, capture_output=True)
            made = read_image(tmp_path / "linear.exr")
            are_right.append(np.allclose(made, expected, rtol=2 * tolerance.half, atol=tolerance.plate))
        return lines[2:], are_right

    return run


@pytest.mark.parametrize(("name", "is_associated"), [("a.png", False), ("a.tif", False), ("b.tif", True)])
def test_alpha_is_heeded(printed, covered, tmp_path, name, is_associated):
    if is_associated:
        color, alpha = covered[..., :3].astype(np.uint16), covered[..., 3:].astype(np.uint16)
        covered = np.dstack([color * alpha // 255, alpha]).astype(np.uint8)
    photo = write_image(tmp_path / name, covered, oiio__UnassociatedAlpha=int(not is_associated))
    assert printed(photo) == ([], [True, True])


@pytest.mark.parametrize("name", ["-dash.jpg", "--out.jpg", "{a}.jpg", "${x}.jpg", "it's.jpg", "a:b.jpg", r"a\b.jpg"])
def test_any_name_works(printed, plate, tmp_path, name):
    shutil.copy(plate, tmp_path / name)
    assert printed(name) == ([], [True, True])


@pytest.mark.parametrize("output", ["scene_linear", "ACEScg", "plate"])
def test_exposure_and_primaries_are_in_the_line_with_the_config(printed, plate, tmp_path, output):
    photo = write_tagged(tmp_path / "shot.png", read_image(plate, kind="uint8"), matrix_profile(DISPLAY_P3))
    note = "(The LUT alone adds no exposure, and does not convert Display P3.)"
    assert printed(photo, "--exposure", "gray", "--output-space", output) == ([note], [False, True])


def test_primaries_that_the_config_has_no_space_of_are_named(printed, codes, tmp_path):
    photo = write_tagged(tmp_path / "a.png", codes, matrix_profile(OWN))
    note = "(The config converts to linear Rec.709; the linear EXR keeps the plate's primaries.)"
    assert printed(photo, "--output-space", "plate") == ([note], [True, False])
