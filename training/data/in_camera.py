"""In-camera responses: what measured bodies have in common, and how they differ, in the logarithm of irradiance."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from scipy.ndimage import gaussian_filter1d

from crfnet_core.posterior import IN_CAMERA
from crfnet_core.posterior.responses import LEAST_IRRADIANCE
from crfnet_core.response.curve import SAMPLES, UNIFORM, ResponseCurve
from crfnet_core.types import Float64Array
from training.data.real_photographs import Body

#: Components of the deviations; the first is mostly the headroom. With more nothing changed out of fold.
COMPONENTS = 6

#: Shrinkage of each kind towards all kinds together: the number of bodies that these count as, for its center and for
#: its spread.
PSEUDO_BODIES, PSEUDO_BODIES_OF_SPREAD = 1.0, 4.0

#: Weight of the darkest brightnesses, below code 16 of 255, in the components: noise and black level rule there.
DARK_WEIGHT, DARKEST = 0.2, 64

#: Least distance of a body from the center of its kind, so that no body becomes the center only because it is near:
#: 0.03 stop RMS over the brightnesses from `DARKEST` on.
LEAST_DISTANCE = 0.03 * np.sqrt(SAMPLES - DARKEST)

#: Standard deviation of the logarithm of a draw's distance from the mean: tails heavier than a Gaussian's.
TAILS = 0.25

#: Standard deviation of the Gaussian that smooths measured responses, in samples (3 codes of 255), and how far a
#: response is continued beyond its ends, mirrored in the end point, so that the end point stays.
SMOOTHING, REACH = 12.0, 48


@dataclass(frozen=True)
class InCameraResponses:
    """A distribution of in-camera responses, Gaussian with heavier tails in log2 irradiance: docs/METHOD.md, Eq. 21."""

    #: Kind -> log2 irradiance at 1024 uniform brightnesses, shape (1024,): the geometric median of its bodies.
    centers: dict[str, Float64Array]
    components: Float64Array  # (6, 1024): deviations of one standard deviation each, over all kinds
    spreads: dict[str, float]  # kind -> how far its bodies differ, relative to `components`

    @classmethod
    def from_bodies(cls, bodies: Sequence[Body]) -> Self:
        """Return the distribution of measured bodies: each counts once, however many stacks it has."""
        stacks = {body.key: np.stack([log_irradiance(curve) for curve in body.responses]) for body in bodies}
        rows = {key: stack.mean(axis=0) for key, stack in stacks.items()}
        center = _center(list(rows.values()))
        centers: dict[str, Float64Array] = {
            kind: _shrunk_center([rows[body.key] for body in bodies if body.kind == kind], center) for kind in IN_CAMERA
        }
        deviations = {
            body.key: (stacks[body.key] - centers.get(body.kind, center)) / np.sqrt(len(stacks[body.key]))
            for body in bodies
        }
        components = _components(np.concatenate(list(deviations.values())), bodies=len(bodies))
        squares = {body.key: float((deviations[body.key] ** 2).sum()) for body in bodies}
        return cls(centers, components, {kind: _spread(bodies, squares, kind) for kind in IN_CAMERA})

    def draw(self, kind: str, count: int, rng: np.random.Generator) -> Float64Array:
        """Return responses of a kind, shape (count, 1024)."""
        scores = rng.standard_normal((count, len(self.components))) * np.exp(rng.normal(0, TAILS, (count, 1)))
        deviations = self.spreads[kind] * scores @ self.components
        return np.stack([response_of(row) for row in self.centers[kind] + deviations])


def log_irradiance(curve: ResponseCurve) -> Float64Array:
    """Return log2 of the inverse response at uniform brightnesses, shape (1024,), smooth from `DARKEST` on.

    Measured responses have kinks where one method of measuring hands over to another, near white above all.
    """
    logarithms = np.log2(np.maximum(curve.inverse(UNIFORM), LEAST_IRRADIANCE))
    continued = np.pad(logarithms[DARKEST:], REACH, mode="reflect", reflect_type="odd")
    smooth = gaussian_filter1d(continued, SMOOTHING)
    return np.concatenate([logarithms[:DARKEST], smooth[REACH:-REACH]])


def response_of(logarithms: Float64Array) -> Float64Array:
    """Return the response, shape (1024,), whose inverse has these log2 irradiances, made monotone."""
    irradiance = np.maximum.accumulate(np.exp2(logarithms))
    irradiance = (irradiance - irradiance[0]) / (irradiance[-1] - irradiance[0]) + 1e-7 * UNIFORM
    return np.interp(UNIFORM, irradiance / irradiance[-1], UNIFORM)


def _center(rows: Sequence[Float64Array]) -> Float64Array:
    """Return the geometric median of bodies, shape (1024,): a few lie far from all others, and pull a mean along.

    Its sum of distances from `DARKEST` on is the least. Source: 500 steps of Weiszfeld (1937) from the mean.
    """
    bodies = np.stack(rows)
    median: Float64Array = bodies.mean(axis=0)
    for _ in range(500):
        distances = np.linalg.norm((bodies - median)[:, DARKEST:], axis=1)
        nearness = 1 / np.maximum(distances, LEAST_DISTANCE)
        median = nearness @ bodies / nearness.sum()
    return median


def _shrunk_center(rows: Sequence[Float64Array], center: Float64Array) -> Float64Array:
    """Return the center of the bodies of a kind, shape (1024,), drawn towards the center of all by `PSEUDO_BODIES`."""
    if not rows:
        return center
    return center + (_center(rows) - center) * len(rows) / (len(rows) + PSEUDO_BODIES)


def _spread(bodies: Sequence[Body], squares: dict[str, float], kind: str) -> float:
    """Return the RMS deviation of the bodies of a kind relative to all bodies, shrunk towards it."""
    average = float(np.mean(list(squares.values())))
    of_kind = [squares[body.key] for body in bodies if body.kind == kind]
    count = len(of_kind) + PSEUDO_BODIES_OF_SPREAD
    return float(np.sqrt((sum(of_kind) + PSEUDO_BODIES_OF_SPREAD * average) / count / average))


def _components(deviations: Float64Array, *, bodies: int) -> Float64Array:
    """Return the principal components of deviations (N, 1024), each one standard deviation long, shape (6, 1024)."""
    weights = np.where(np.arange(SAMPLES) < DARKEST, DARK_WEIGHT, 1.0)
    _, lengths, directions = np.linalg.svd(deviations * weights, full_matrices=False)
    deviation = lengths[:COMPONENTS] / np.sqrt(max(bodies - len(IN_CAMERA) - 1, 1))
    return deviation[:, None] * directions[:COMPONENTS] / weights
