"""What is said of photographs and estimates everywhere: in words, in JSON, in LUT files and on the sheet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crfnet_core.estimate import ResponseEstimate
from crfnet_core.photo import Photo
from crfnet_core.response import SAMPLES


@dataclass(frozen=True)
class PhotoFacts:
    """What the report says of a photograph once its pixels are gone: file name, size in pixels, bits per sample."""

    name: str
    width: int
    height: int
    bit_depth: int

    @classmethod
    def of(cls, photo: Photo) -> PhotoFacts:
        """Return the facts of a photograph."""
        height, width = photo.pixels.shape[:2]
        return cls(photo.path.name, width, height, photo.bit_depth)

    def __str__(self) -> str:
        """Return one line for people."""
        return f"{self.name}: {self.width} x {self.height}, {self.bit_depth} bits"


def brightness_percent(error: float) -> float:
    """Return an estimation error as a root mean square in percent of the brightness range.

    E_est is the Euclidean distance between two responses of `SAMPLES` samples, so the root mean square is
    E_est / sqrt(SAMPLES).
    """
    return float(100 * error / np.sqrt(SAMPLES))


def agreeing(estimate: ResponseEstimate) -> str:
    """Return in words how many windows agree with the others."""
    return f"{sum(window.kept for window in estimate.windows)} of {len(estimate.windows)} windows agree"


def provenance(estimate: ResponseEstimate) -> tuple[str, ...]:
    """Return the comment lines of LUT files: what the LUT is, its photographs, its model, and how far to trust it."""
    return (
        "Inverse camera response: encoded brightness in, relative scene-linear irradiance out",
        f"Photographs: {', '.join(estimate.photos)}",
        f"Model: {estimate.model}",
        f"Verdict: {estimate.verdict}, expected estimation error {estimate.uncertainty:.2f}"
        f" ({brightness_percent(estimate.uncertainty):.1f} % of the brightness range)",
    )
