"""Linearise plates: encoded files and frame sequences to scene-linear OpenEXR."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from crfnet_core.errors import CRFNetError, PlateError
from crfnet_core.files import atomic_write, check_target
from crfnet_core.image_io import first_line
from ocio.luts.lut1d import Lut1D
from ocio.plates.frames import (
    EncodedFrame,
    FramePattern,
    FrameSequence,
    find_frames,
    format_frames,
    read_frame,
)

#: What a linear plate says of its colours: linear, with the primaries of the plate, which are taken as Rec.709.
COLOR_INTEROP_ID = "lin_rec709_scene"

#: Metadata that still holds for the linear plate, under OpenImageIO's names. Colour profiles do not.
KEPT_METADATA = (
    "DateTime",
    "Exif:ExposureBiasValue",
    "Exif:FocalLength",
    "Exif:ISOSpeedRatings",
    "Exif:LensModel",
    "Exif:PhotographicSensitivity",
    "ExposureTime",
    "FNumber",
    "FramesPerSecond",
    "Make",
    "Model",
    "Orientation",
    "PixelAspectRatio",
    "smpte:KeyCode",
    "smpte:TimeCode",
)

#: NumPy's types of the two depths.
DEPTHS: dict[str, np.dtype[np.floating[Any]]] = {"half": np.dtype(np.float16), "float": np.dtype(np.float32)}

#: Frames in work at a time unless told otherwise: each takes some 20 bytes per pixel.
MAX_WORKERS = 8

#: Seconds after which a temporary file that nobody writes to is what a killed run has left behind.
STALE_SECONDS = 600

_ROWS = 64
_LEFTOVER = re.compile(r"\.(.+)\.[a-z0-9_]{8}(\.exr)", re.IGNORECASE)  # as `atomic_write` names them


@dataclass(frozen=True)
class PlateReport:
    """What became of the frames.

    Parameters
    ----------
    written : tuple of Path
        The files written by this run.
    skipped : tuple of Path
        The files that were there already and were left alone.
    missing : tuple of int
        Frame numbers for which there is no plate.
    """

    written: tuple[Path, ...]
    skipped: tuple[Path, ...]
    missing: tuple[int, ...]


def linearize_plates(
    plates: str | Path,
    out: str | Path,
    lut: Lut1D,
    *,
    frames: str | Iterable[int] | None = None,
    depth: str = "half",
    exposure: float = 0.0,
    workers: int | None = None,
    overwrite: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> PlateReport:
    """Write a plate, or every frame of a sequence, as scene-linear OpenEXR: lut.apply(B) * 2 ** exposure.

    Plates are whatever `read_photo` reads, and OpenEXR whose values are encoded (8-bit frames wrapped in EXR, say);
    an EXR that calls itself linear in `colorInteropID` is refused. Gray becomes RGB. Alpha is kept: the colour is
    divided by it where the file stores the product, and multiplied by it after the LUT, as OpenEXR wants it. Rows and
    columns stay as stored, and so does the metadata that remains true (`KEPT_METADATA`). The output is compressed
    with zips, says `COLOR_INTEROP_ID`, carries the comments of the LUT, and is the same byte for byte in every run.

    A frame that is there under its final name is finished, because files get their name once they are whole; without
    `overwrite` it is left alone, so the same call resumes an interrupted one. Remove the files, or overwrite them,
    after a change of the LUT or the exposure. Temporary files left by a killed run are removed `STALE_SECONDS` later.
    Frames for which there is no plate are only reported; a frame that fails does not stop the others.

    Parameters
    ----------
    plates : str or Path
        A file, or a sequence such as `plate.%04d.png` or `plate.####.png` (see `find_frames`).
    out : str or Path
        The .exr file, or the sequence, to be written; its folder must exist.
    lut : Lut1D
        The inverse response: encoded brightness to linear irradiance.
    frames : str, iterable of int, or None
        The frames to use, like "1001-1100" or "1-99x2"; all by default.
    depth : {"half", "float"}
        The samples of the output.
    exposure : float
        Stops by which the linear values are raised.
    workers : int or None
        Frames in work at a time; by default one per core, but not more than `MAX_WORKERS`.
    overwrite : bool
        Whether finished frames are written again.
    progress : callable or None
        Called in this thread with the finished (and skipped) frames so far, and all.

    Raises
    ------
    PlateError
        If the plates are not found, the outputs cannot be written or would replace the plates, an option is out of
        range, or, after all others are written, some frames failed: it names them.
    """
    scale = _scale(lut, depth, exposure)
    sequence = find_frames(plates, frames)
    jobs = dict(zip(_targets(out, sequence), sequence.paths, strict=True))
    skipped = tuple(target for target in jobs if not overwrite and target.exists())
    pending = {target: path for target, path in jobs.items() if target not in set(skipped)}
    _remove_leftovers(pending)
    failures: dict[Path, CRFNetError] = {}
    with _started(pending, _worker_count(workers), lut, scale, depth, overwrite) as futures:
        _report(progress, len(skipped), len(jobs))
        for done, future in enumerate(as_completed(futures), len(skipped) + 1):
            try:
                future.result()
            except CRFNetError as problem:
                failures[futures[future]] = problem
            _report(progress, done, len(jobs))
    if failures:
        raise PlateError(_failure(failures, jobs, sequence))
    return PlateReport(tuple(pending), skipped, sequence.missing)


def _scale(lut: Lut1D, depth: str, exposure: float) -> float:
    """Return the factor of the exposure after checking the options of the output."""
    if depth not in DEPTHS:
        raise PlateError(f"depth {depth!r} is unknown; choose half or float")
    try:
        scale = float(2.0**exposure)
    except OverflowError:
        scale = np.inf
    peak = float(np.abs(lut.values).max()) * scale
    if not 0 < scale < np.inf or not peak <= np.finfo(np.float32).max:
        raise PlateError(f"an exposure of {exposure} stops is out of range; give one like -2 or 1.5")
    if not peak <= float(np.finfo(DEPTHS[depth]).max):
        raise PlateError(f"values up to {peak:.6g} do not fit into half floats; ask for float, or for less exposure")
    return scale


def _targets(out: str | Path, sequence: FrameSequence) -> list[Path]:
    """Return the file to be written for every frame after checking that none of them replaces a plate."""
    out = Path(out)
    if out.suffix.lower() != ".exr":
        raise PlateError(f"{out}: linear plates are OpenEXR; give a name that ends in .exr")
    targets = [out]
    if sequence.numbers:
        pattern = FramePattern.parse(out)
        if pattern is None:
            count = len(sequence.paths)
            raise PlateError(f"{out}: one name for {count} frames; put their number into it, as in plate.%04d.exr")
        targets = [pattern.path(number) for number in sequence.numbers]
    check_target(targets[0], overwrite=True, error=PlateError)
    plates = {path.resolve() for path in sequence.paths}
    for target in targets:
        if target.resolve() in plates:
            raise PlateError(f"{target}: is one of the plates, which are never replaced; choose another name")
    return targets


def _worker_count(workers: int | None) -> int:
    """Return the number of frames in work at a time."""
    if workers is not None and workers < 1:
        raise PlateError(f"{workers} workers cannot work; give 1 or more")
    return workers or min(os.cpu_count() or 1, MAX_WORKERS)


def _remove_leftovers(targets: Iterable[Path]) -> None:
    """Remove old temporary files of frames that are about to be written; younger ones may be another process's."""
    targets = set(targets)
    for folder in {target.parent for target in targets}:
        for path in folder.iterdir():
            match = _LEFTOVER.fullmatch(path.name)
            if match and folder / (match[1] + match[2]) in targets:
                with suppress(OSError):
                    if time.time() - path.stat().st_mtime > STALE_SECONDS:
                        path.unlink()


@contextmanager
def _started(
    jobs: dict[Path, Path], workers: int, lut: Lut1D, scale: float, depth: str, overwrite: bool
) -> Iterator[dict[Future[None], Path]]:
    """Yield the futures of the frames; on the way out those not begun are dropped and those begun are finished."""
    pool = ThreadPoolExecutor(workers, thread_name_prefix="plate")
    try:
        yield {
            pool.submit(_linearize, path, target, lut, scale, depth, overwrite): target for target, path in jobs.items()
        }
    finally:
        pool.shutdown(cancel_futures=True)


def _report(progress: Callable[[int, int], None] | None, done: int, total: int) -> None:
    """Tell the progress to whom it may concern."""
    if progress is not None:
        progress(done, total)


def _failure(failures: dict[Path, CRFNetError], jobs: dict[Path, Path], sequence: FrameSequence) -> str:
    """Return the message that names the frames that failed."""
    failed = [target for target in jobs if target in failures]
    first = failures[failed[0]]
    if not sequence.numbers:
        return str(first)
    numbers = format_frames([n for n, target in zip(sequence.numbers, jobs, strict=True) if target in failures])
    return f"{len(failed)} of {len(jobs)} frames failed ({numbers}) and the others are written; the first: {first}"


def _linearize(path: Path, target: Path, lut: Lut1D, scale: float, depth: str, overwrite: bool) -> None:
    """Read one plate and write its linear EXR."""
    plate = read_frame(path)
    pixels = _linear_pixels(plate, lut, scale, depth)
    header = _output_header(plate.header, pixels.shape[2], depth, lut.comments)
    with atomic_write(target, overwrite=overwrite, error=PlateError) as temporary:
        _write_exr(temporary, header, pixels, name=target)


def _linear_pixels(plate: EncodedFrame, lut: Lut1D, scale: float, depth: str) -> NDArray[Any]:
    """Return lut.apply(B) * scale, times alpha, and alpha: shape (H, W, 3 or 4), of the type of `depth`."""
    height, width, _ = plate.samples.shape
    linear = np.empty((height, width, 3 if plate.alpha is None else 4), DEPTHS[depth])
    is_coded = plate.samples.dtype.kind == "u"
    codes = np.arange(plate.largest + 1) / plate.largest
    table = (lut.apply(codes) * scale).astype(np.float32 if plate.alpha is not None else linear.dtype)
    for top in range(0, height, _ROWS):
        rows = slice(top, top + _ROWS)
        block = plate.samples[rows]
        values = np.take(table, block) if is_coded else lut.apply(block) * np.float32(scale)
        if plate.alpha is not None:
            alpha = plate.alpha[rows, :, None]
            values = values * alpha
            linear[rows, :, 3:] = alpha
        linear[rows, :, :3] = values
    return linear


def _output_header(source: Any, channels: int, depth: str, comments: Sequence[str]) -> Any:
    """Return the header of the linear EXR: geometry and true metadata of the plate, colour space and provenance."""
    header = oiio.ImageSpec(source.width, source.height, channels, depth)
    for name in ("x", "y", "full_x", "full_y", "full_width", "full_height"):
        setattr(header, name, getattr(source, name))
    header.attribute("DateTime", "")  # else OpenImageIO writes the time of day
    for attribute in source.extra_attribs:
        if attribute.name in KEPT_METADATA:
            header.attribute(attribute.name, attribute.type, attribute.value)
    header.attribute("compression", "zips")
    header.attribute("colorInteropID", COLOR_INTEROP_ID)
    if comments:
        header.attribute("crfnet:response", " | ".join(comments))
    return header


def _write_exr(path: Path, header: Any, pixels: NDArray[Any], *, name: Path) -> None:
    """Write a whole OpenEXR file; errors call it `name`."""
    output = oiio.ImageOutput.create(str(path))
    problem = oiio.geterror()
    if output is None:
        raise PlateError(f"{name}: cannot be written ({first_line(problem)}); check the OpenImageIO installation")
    is_written = output.open(str(path), header) and output.write_image(pixels)
    is_closed = output.close()
    problem = output.geterror()
    if problem or not (is_written and is_closed):
        raise PlateError(f"{name}: cannot be written ({first_line(problem)}); check the disk")
