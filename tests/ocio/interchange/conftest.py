"""Responses, and an exposure series through known ones, for the programs that calibrate."""

import shutil
import subprocess

import numpy as np
import pytest

from crfnet.luts.lut1d import inverse_response_lut
from crfnet.luts.rgb_lut import RgbLut1D
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.images import write_image

#: Exposure times of the series, in seconds.
TIMES = (1 / 8, 1 / 4, 1 / 2, 1, 2, 4, 8)


@pytest.fixture(scope="session")
def curves():
    """The responses of R, G and B."""
    return [ResponseCurve.gamma(exponent) for exponent in (2.2, 1.8, 2.0)]


@pytest.fixture(scope="session")
def rgb_lut(curves):
    """Their inverses."""
    return RgbLut1D(tuple(inverse_response_lut(curve) for curve in curves))


@pytest.fixture(scope="session")
def light():
    """The light of a scene, shape (60, 80, 3), over six stops."""
    random = np.random.default_rng(1)
    return np.sort(np.exp(random.uniform(-6, 0.7, (4800, 3))), axis=0).reshape(60, 80, 3)


@pytest.fixture(scope="session")
def series(light, curves, tmp_path_factory):
    """The files of an exposure series of that scene through these responses, with their exposure times."""
    folder = tmp_path_factory.mktemp("series")
    files = {}
    for time in TIMES:
        codes = [curve.forward(np.clip(light[..., channel] * time, 0, 1)) for channel, curve in enumerate(curves)]
        pixels = np.rint(255 * np.stack(codes, axis=-1)).astype(np.uint8)
        files[write_image(folder / f"{time:.3f}.png", pixels)] = time
    return files


@pytest.fixture
def tool(tmp_path):
    """Run another program in tmp_path; skips the test where it is not installed."""

    def run(*command, stdin=None):
        if shutil.which(command[0]) is None:
            pytest.skip(f"needs {command[0]}")
        given = list(map(str, command))
        return subprocess.run(given, cwd=tmp_path, input=stdin, capture_output=True, check=True).stdout

    return run
