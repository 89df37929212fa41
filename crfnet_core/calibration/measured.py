"""A measured response: of an exposure stack, or of raw files and their JPEGs."""

import math
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np

from crfnet_core.calibration.exposures import ExposureLabel
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

    shape: dict[str, float]  # of `crfnet_core.response.metrics.shape_error`
    scale: dict[str, float]  # of `crfnet_core.response.metrics.scale_error`

    @property
    def shape_stops(self) -> float:
        """The root of the sum of their squares."""
        return math.hypot(*self.shape.values())

    @property
    def scale_stops(self) -> float:
        """The same of the scale."""
        return math.hypot(*self.scale.values())


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

    def compare(self, other: ResponseCurve) -> dict[str, float]:
        """Return the errors of another response, such as an estimate, by name; E_lin is of the best exposed frame."""
        errors = {error.__name__: error(self.curve, other) for error in (estimation_error, shape_error, scale_error)}
        steps = np.arange(256) / 255
        return errors | {"linearization_error": linearization_error(steps, self.curve, other, counts=self.counts)}


@dataclass(frozen=True, eq=False)
class FrameReport:
    """One frame of a measured stack."""

    path: Path
    label: ExposureLabel  # its exposure by EXIF or as given
    stops: float  # its exposure as used, relative to the mean of the stack
    #: Shape (C,): stops by which it is brighter than that, in each channel (one if gray); NaN if it was left out.
    offsets: Float64Array
    shift: tuple[int, int]  # rows and columns in pixels by which it was displaced
    residual: float  # as of `MeasuredResponse`; NaN if it was left out
    is_used: bool  # whether it fits the others


@dataclass(frozen=True, eq=False, kw_only=True)
class Calibration(MeasuredResponse):
    """A response measured from an exposure stack."""

    white: float  # code of white as a part of the largest code
    reaches_white: bool  # whether white was seen; otherwise the scale comes from similar known responses
    labels: str  # the reading of the exposure labels: "nominal", or "exact powers of two"
    nearest_known: float  # E_est between it and the nearest packaged response, both in parts of their own white
    frames: tuple[FrameReport, ...]  # in the order of the files


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
