"""Exposures of the frames of a stack, in stops: from EXIF or given times, as labeled and as cameras really expose."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from crfnet_core.errors import CalibrationError
from crfnet_core.photograph.metadata.header_colors import header_attribute
from crfnet_core.types import Float64Array, is_number

#: Stops that the exposures of a stack have to span.
LEAST_RANGE = 2.0

#: Stops that sums and differences of exposures may be off by: 1/1000 to 1/250 s may come to 1.9999999999999991.
ROUNDING = 1e-6

#: Steps of a camera to a stop -> the largest distance in stops between a label and the exposure that it stands for:
#: 1/60 s means 2^-6 s (0.093), and in half stops 1/20 s means 2^-4.5 s (0.178).
LABEL_ERRORS = {3: 0.13, 2: 0.18}


@dataclass(frozen=True)
class ExposureLabel:
    """A frame's exposure by its file or by the user; None where neither states it."""

    seconds: float | None = None  # exposure time
    f_number: float | None = None  # focal length over aperture
    iso: float | None = None  # sensitivity
    file_seconds: float | None = None  # exposure time by the file, also if the user states another

    @classmethod
    def from_header(cls, header: Any, seconds: float | None = None) -> Self:
        """Return EXIF's exposure, from an `OpenImageIO.ImageSpec`, or with the time that a user states.

        Raise CalibrationError if this is not a positive number.
        """
        if seconds is not None and not _is_positive(seconds):
            raise CalibrationError("bad_seconds", text=seconds)
        names = ("ExposureTime", "FNumber", "Exif:PhotographicSensitivity")
        values = [header_attribute(header, name) for name in names]
        time, f_number, iso = (float(value) if _is_positive(value) else None for value in values)
        return cls(seconds or time, f_number, iso, time)


@dataclass(frozen=True, eq=False)
class Exposures:
    """The exposures of a stack."""

    nominal: Float64Array  # (T,): log2 of seconds x ISO / f-number^2, as labeled, relative to the mean over the stack
    #: Shape (T,): the same with each factor on the exact power of two that its label stands for; None if labels stand
    #: for none.
    snapped: Float64Array | None
    differing: tuple[str, ...]  # the settings other than the time that differ between the frames: "ISO", "aperture"


def stack_exposures(labels: Sequence[ExposureLabel]) -> Exposures:
    """Return the exposures of frames; each label needs its time.

    ISO and aperture count where every frame states them. A scene's light on the sensor is proportional to
    seconds / f-number^2, and the code values follow its product with ISO (ISO 12232).
    """
    seconds = _stops([label.seconds for label in labels])
    iso, aperture = _stops([label.iso for label in labels]), -2 * _stops([label.f_number for label in labels])
    parts = [seconds, iso, aperture]
    snapped = [part for part in map(_snapped, parts) if part is not None]
    differing = [name for name, part in (("ISO", iso), ("aperture", aperture)) if np.ptp(part) > 0]
    return Exposures(_centered(parts), _centered(snapped) if len(snapped) == len(parts) else None, tuple(differing))


def parse_times(text: str) -> tuple[float, ...]:
    """Return the seconds in "1/60,1/30,0.5". Raise CalibrationError if one is not a positive number."""
    return tuple(_seconds(part.strip()) for part in text.split(","))


def _seconds(text: str) -> float:
    """Return the seconds in "1/60", "0.5s" or "2"."""
    numerator, _, denominator = text.removesuffix("s").partition("/")
    with suppress(ValueError, ZeroDivisionError):
        if _is_positive(value := float(numerator) / float(denominator or 1)):
            return value
    raise CalibrationError("bad_seconds", text=text)


def _is_positive(value: Any) -> bool:
    """Return whether a value is a positive, finite number."""
    return is_number(value, least=0) and bool(value)


def _centered(parts: Sequence[Float64Array]) -> Float64Array:
    """Return the sum of stops, relative to its mean."""
    total = np.sum(parts, axis=0)
    return np.asarray(total - total.mean(), dtype=np.float64)


def _stops(values: Sequence[float | None]) -> Float64Array:
    """Return log2 of the values, or zeros where one of them is unknown."""
    known = [value for value in values if value is not None]
    return np.log2(known) if len(known) == len(values) else np.zeros(len(values))


def _snapped(stops: Float64Array) -> Float64Array | None:
    """Return stops on the grid of thirds or of halves that is nearer, or None if a label is too far from both."""
    if not np.ptp(stops):
        return stops  # a setting that all frames share has no effect, whatever it is
    grids = [(np.round(stops * step) / step, most) for step, most in LABEL_ERRORS.items()]
    near = [grid for grid, most in grids if np.abs(grid - stops).max() <= most]
    return min(near, key=lambda grid: float(np.abs(grid - stops).sum())) if near else None
