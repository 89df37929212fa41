"""The oiiotool lines that `crfnet estimate` prints make the plate that it writes, also of plates with alpha."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from crfnet_core.colorimetry import Primaries
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
def printed(estimate, tmp_path, monkeypatch):
    """Run `crfnet estimate`, return what it prints after the files, and the pictures that its oiiotool lines make."""
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.chdir(tmp_path)

    def run(photo, *options):
        lines = [line.strip() for line in estimate(photo, *options).out.splitlines()]
        lines = lines[lines.index("The linear plate in oiiotool, with the LUT or the config:") + 1 :]
        made = []
        for line in lines[:2]:
            subprocess.run(line, shell=True, check=True, capture_output=True)
            made.append(read_image(tmp_path / "linear.exr"))
        return lines, made

    return run


@pytest.mark.parametrize(("name", "is_associated"), [("a.png", False), ("a.tif", False), ("b.tif", True)])
def test_alpha_is_heeded(printed, covered, tmp_path, tolerance, name, is_associated):
    if is_associated:
        color, alpha = covered[..., :3].astype(np.uint16), covered[..., 3:].astype(np.uint16)
        covered = np.dstack([color * alpha // 255, alpha]).astype(np.uint8)
    photo = write_image(tmp_path / name, covered, oiio__UnassociatedAlpha=int(not is_associated))
    _, made = printed(photo)
    expected = read_image(tmp_path / "out" / f"{photo.stem}_linear.exr")
    for linear in made:
        np.testing.assert_allclose(linear, expected, rtol=2 * tolerance.half, atol=tolerance.plate)


def test_primaries_that_the_config_has_no_space_of_are_named(printed, codes, tmp_path, tolerance):
    photo = write_tagged(tmp_path / "a.png", codes, matrix_profile(OWN))
    lines, (linear, _) = printed(photo, "--output-space", "plate")
    assert lines[2:] == ["(The config converts to linear Rec.709; the linear EXR keeps the plate's primaries.)"]
    expected = read_image(tmp_path / "out" / "a_linear.exr")
    np.testing.assert_allclose(linear, expected, rtol=2 * tolerance.half, atol=tolerance.plate)
