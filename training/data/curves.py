"""Camera responses to train and measure on: DoRF, in-camera base curves, and mixtures of each."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.io
from scipy.interpolate import PchipInterpolator

from crfnet_core.response.curve import UNIFORM, ResponseCurve
from crfnet_core.response.transfer_functions import srgb_encode
from crfnet_core.types import Float64Array
from training.data.scenes import table_rows

#: The files of responses in a data folder: DoRF, the published EMoR basis, and in-camera tone curves.
DORF_FILE, EMOR_FILE, BASE_CURVES_FILE = "dorf/201_CRF_data.mat", "dorf/emor.txt", "camera_curves/base_curves.csv"

#: Returns a random response, shape (1024,), from 0 to 1.
DrawResponse = Callable[[np.random.Generator], Float64Array]

#: Range of the headroom s that a camera leaves between its brightest JPEG value and the clipping of its sensor.
HEADROOM = (0.4, 1.1)


def read_dorf(data: Path) -> Float64Array:
    """Return the 201 measured responses of DoRF in a data folder, shape (201, 1024), at uniform irradiances."""
    return np.asarray(scipy.io.loadmat(data / DORF_FILE)["B"], dtype=np.float64)


def read_base_curves(path: Path) -> dict[str, PchipInterpolator]:
    """Return camera name -> monotone tone curve, from scene-linear to display-linear values, both in [0, 1]."""
    nodes: dict[str, list[tuple[float, float]]] = {}
    for row in table_rows(path):
        nodes.setdefault(row["name"], []).append((float(row["scene_linear"]), float(row["display_linear"])))
    return {name: PchipInterpolator(*np.array(points).T) for name, points in nodes.items()}


def camera_response(base: PchipInterpolator, headroom: float) -> Float64Array:
    """Return f(E) = sRGB(base(min(1, s E))), divided by f(1), shape (1024,), for the headroom s."""
    encoded = srgb_encode(np.clip(base(np.minimum(1, headroom * UNIFORM)), 0, 1))
    return encoded / encoded[-1]


def curve_of_inverse(irradiance: Float64Array) -> ResponseCurve:
    """Return the response whose inverse has these irradiances, shape (1023,), at the uniform brightnesses above 0."""
    return ResponseCurve.from_samples(np.interp(UNIFORM, np.concatenate([[0.0], irradiance]), UNIFORM))


@dataclass(frozen=True)
class CurveSource:
    """A family of responses that training draws from."""

    dorf: Float64Array  # (N, 1024): measured responses
    bases: tuple[PchipInterpolator, ...]  # in-camera base curves
    camera_fraction: float = 0.5  # fraction, in [0, 1], of the responses that come from `bases`
    #: Standard deviation of the logarithms of the two powers, on irradiance and on brightness, that vary a response.
    warp: float = 0.15
    plain_fraction: float = 0.5  # fraction, in [0, 1], of the responses from `dorf` that are left as they were measured

    def draw(self, rng: np.random.Generator) -> Float64Array:
        """Return one response, shape (1024,), from 0 to 1."""
        if rng.random() < self.camera_fraction:
            chosen = rng.integers(len(self.bases), size=2)
            curves = np.stack([camera_response(self.bases[i], rng.uniform(*HEADROOM)) for i in chosen])
            return self._warped(self._mixed(curves, rng), rng, self.warp / 2)
        if rng.random() < self.plain_fraction:
            return self.dorf[rng.integers(len(self.dorf))]
        return self._warped(self._mixed(self.dorf[rng.integers(len(self.dorf), size=3)], rng), rng, self.warp)

    def _mixed(self, curves: Float64Array, rng: np.random.Generator) -> Float64Array:
        """Return a random convex mixture, most often near one of the curves."""
        return rng.dirichlet(np.full(len(curves), 0.4)) @ curves

    def _warped(self, curve: Float64Array, rng: np.random.Generator, sigma: float) -> Float64Array:
        """Return f(E ** p) ** q with log-normal powers."""
        p, q = np.exp(rng.normal(0, sigma, 2))
        return np.interp(UNIFORM**p, UNIFORM, curve) ** q
