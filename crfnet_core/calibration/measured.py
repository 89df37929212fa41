"""A measured response: of an exposure stack, or of raw files and their JPEGs."""

import math
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np

from crfnet_core.errors import Notice
from crfnet_core.photograph.metadata import FileMetadata
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import estimation_error, linearization_error, scale_error, shape_error
from crfnet_core.types import Float64Array

#: Part of the difference between the channels' own responses that counts: they have a response in common.
CHANNEL_PART = 0.5


@dataclass(frozen=True)
class Uncertainty:
    """Standard deviations in stops, each with its parts by name."""

    shape: dict[str, float]  # parts of the shape's: see `crfnet_core.response.metrics.shape_error`
    scale: dict[str, float]  # parts of the scale's: see `crfnet_core.response.metrics.scale_error`

    @property
    def shape_stops(self) -> float:
        """The root of the sum of squares of the shape's parts."""
        return math.hypot(*self.shape.values())

    @property
    def scale_stops(self) -> float:
        """The same of the scale's parts."""
        return math.hypot(*self.scale.values())


@dataclass(frozen=True)
class Comparison:
    """Errors of another response by the functions of these names; E_lin is of the best exposed frame."""

    estimation_error: float
    linearization_error: float
    shape_error: float
    scale_error: float


@dataclass(frozen=True, eq=False, kw_only=True)
class MeasuredResponse:
    """A measured response, and how far it may be off."""

    #: The response. Its brightness is a part of the file's largest code, as in `points` and `counts`: where the camera
    #: clips below that code, the response reaches `white` and jumps to 1.
    curve: ResponseCurve
    weights: Float64Array  # (11,): its EMoR weights
    uncertainty: Uncertainty  # of its shape and of its scale, in stops
    residual: float  # root mean square of brightness less the model's, in 8-bit codes of the file
    metadata: FileMetadata  # the header of the first file
    #: Shape (N, 4 or more): the samples: log2 of irradiance (white = 0), brightness, brightness less the model's,
    #: number of the file.
    points: Float64Array
    counts: Float64Array  # (256,): how often each of 256 steps of brightness occurs in the best exposed file
    warnings: tuple[Notice, ...]  # doubts about the measurement

    def compare(self, other: ResponseCurve) -> Comparison:
        """Return how far another response, such as an estimate, is from this one."""
        steps = np.arange(256) / 255
        return Comparison(
            estimation_error=estimation_error(self.curve, other),
            linearization_error=linearization_error(steps, self.curve, other, counts=self.counts),
            shape_error=shape_error(self.curve, other),
            scale_error=scale_error(self.curve, other),
        )


class WhiteBasis(StrEnum):
    """How it is known where white is."""

    SEEN = "seen"  # surfaces reach it whose raw light is not saturated
    RAW_CLIP = "RAW clip"  # it is where the sensor saturates
    EXTRAPOLATED = "extrapolated"  # from codes that come near
    BRACKETED = "bracketed"  # between the brightest code seen and saturation of the sensor


@dataclass(frozen=True)
class ShotReport:
    """One pair of a measurement."""

    path: Path  # the raw file
    jpeg: Path | None  # None if the JPEG is the one inside
    iso: int | None
    cells: int
    offset: float  # stops by which the JPEG is brighter than the first one's, at equal raw light
    residual: float  # root mean square of brightness less the model's, in 8-bit codes
    correlation: float  # of JPEG and raw picture, laid on each other


@dataclass(frozen=True, eq=False, kw_only=True)
class PairCalibration(MeasuredResponse):
    """A response measured from raw files and their JPEGs.

    The further columns of `points` are the distance from the center, chroma in 0 to 1, log2 of the surroundings' light,
    and the channel.
    """

    white_basis: WhiteBasis
    codes_seen: tuple[float, float]  # the least and the largest 8-bit code
    matrix: Float64Array  # (3, 3): from balanced raw light to the light of the response
    local: float  # exponent of the surroundings' light in the gain: 0 without local tone mapping
    corner: float  # stops by which the camera brightens the corners
    shots: tuple[ShotReport, ...]
