"""Plates to linearize, and the results."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from crfnet.luts.lut1d import Lut1D, inverse_response_lut
from crfnet.options import PlateOptions
from crfnet.plates.frames import find_frames
from crfnet.plates.linear import PlateReport, linear_targets, linearize_plates
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.types import Progress
from tests.helpers.images import read_image, write_image

#: The inverse of gamma 2.2, with provenance.
LUT = inverse_response_lut(ResponseCurve.gamma(2.2), comments=("photograph plate.jpg", "model test"))

#: Random 8-bit codes, shape (70, 90, 4).
SMALL = np.random.default_rng(0).integers(0, 256, (70, 90, 4), dtype=np.uint8)


def linearize(
    plates: str | Path,
    out: str | Path,
    lut: Lut1D,
    *,
    frames: str | Iterable[int] | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> PlateReport:
    """Linearize the file or the sequence `plates` into `out`; `options` are as of `PlateOptions`."""
    sequence = find_frames(plates, frames)
    targets = linear_targets(out, sequence)
    return linearize_plates(sequence, targets, lut, PlateOptions(**options), workers=workers, progress=progress)


def write_sequence(folder: Path, numbers: Iterable[int], name: str = "plate.{:04d}.png") -> Path:
    """Write a different frame for every number and return the pattern of the default name."""
    for number in numbers:
        write_image(folder / name.format(number), np.roll(SMALL[..., :3], number, axis=0))
    return folder / "plate.%04d.png"


def read_exr(path: Path) -> tuple[NDArray[Any], Any]:
    """Return the pixels of an EXR as float32, shape (H, W, C), and its header."""
    return read_image(path), oiio.ImageBuf(str(path)).nativespec()


def attributes(spec: Any) -> dict[str, Any]:
    """Return the metadata of a header by name."""
    return {attribute.name: attribute.value for attribute in spec.extra_attribs}
