"""Linearize plates: encoded files and frame sequences to scene-linear OpenEXR."""

import os
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import closing
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from crfnet_core.errors import CRFNetError
from crfnet_core.files import atomic_write, check_target
from crfnet_core.photograph.image_io import MAX_PIXELS
from crfnet_core.photograph.metadata.color_tags import ColorTags
from crfnet_core.photograph.recognition import refuse_linear
from crfnet_core.types import Progress, cores, show_progress

from ..errors import PlateError, error_of_file
from ..luts.rgb_lut import AnyLut
from ..options import PlateOptions
from .exr import SAMPLE_TYPES, linear_header, write_exr
from .frame_files import EncodedFrame, FirstFrame, FrameLoader, FrameSource, first_frame, frame_path
from .frame_numbers import format_frames
from .frame_pattern import FramePattern
from .frames import FrameSequence, identities
from .light import PLATE, PlateLight, check_finished
from .primaries import check_same_primaries, plate_primaries

Name = TypeVar("Name")

#: Frames linearized at a time by default, fewer if they have more than `MAX_PIXELS` together: each needs about 20 bytes
#: of memory per pixel.
MAX_WORKERS = 8

#: Rows linearized at a time, which keeps the memory for intermediate values small.
_ROWS = 64


@dataclass(frozen=True)
class PlateReport:
    """The files that a run wrote, the finished files that it left alone, the numbers without a plate, and the light."""

    written: tuple[Path, ...]
    skipped: tuple[Path, ...]
    missing: tuple[int, ...]
    light: PlateLight
    clipped: float  # the share of the encoded values that were outside the LUT's domain, in the files written
    sizes: tuple[tuple[int, ...], ...]  # the different widths and heights of the files written


def linear_targets(out: str | Path, sequence: FrameSource) -> tuple[Path, ...]:
    """Return the linear EXR file of every frame; raise a PlateError if `out` is no file or pattern, or a plate."""
    out = Path(out)
    if out.suffix.lower() != ".exr":
        raise PlateError("not_exr", path=out)
    targets = [out]
    if sequence.numbers:
        pattern = FramePattern.parse(out)
        if pattern is None:
            raise PlateError("no_placeholder", path=out, count=len(sequence.numbers))
        targets = [pattern.path(number) for number in sequence.numbers]
    plates = {os.path.realpath(path) for path in sequence.paths}
    for target in targets:
        if os.path.realpath(target) in plates:
            raise PlateError("target_is_plate", path=target)
    return tuple(targets)


def linearize_plates(
    sequence: FrameSource,
    targets: Sequence[Path],
    lut: AnyLut,
    options: PlateOptions,
    *,
    workers: int | None = None,
    progress: Progress | None = None,
) -> PlateReport:
    """Write a plate, or every frame of a sequence, as scene-linear OpenEXR: matrix @ lut.apply(B) * 2 ** exposure.

    Unless `overwrite` is set, targets that exist are left alone, so that the same call resumes an interrupted one.
    `workers` frames, by default at most one a core, are in memory. Raise a CRFNetError before any frame is written if
    the output does not fit the depth, or `check_finished` refuses a target; at the end if frames failed.
    """
    check_target(targets[0], overwrite=True, error=PlateError)
    if workers is not None and workers < 1:
        raise PlateError("bad_workers", workers=workers)
    if options.is_encoded and isinstance(sequence, FrameSequence):
        sequence = replace(sequence, is_encoded=True)
    plate_of, first = identities(sequence), first_frame(sequence)
    if first and not options.is_encoded:
        refuse_linear(first.frame.color, first.path)
    light = PlateLight.from_tags(first.frame.color if first else ColorTags(), lut, options)
    conversion = _Conversion(light, _scale(light, options), options, first, plate_of)
    pending = {target: position for position, target in enumerate(targets)}
    skipped = () if options.overwrite else tuple(target for target in targets if target.exists())
    show_progress(progress, len(skipped), len(targets))
    check_finished(((target, plate_of(pending.pop(target))) for target in skipped), light, options.depth)
    failures: dict[Path, CRFNetError] = {}
    elsewhere: list[Path] = []  # finished by another process meanwhile
    loaders = sequence.loaders([*pending.values()])
    jobs = (
        (target, partial(conversion.write, position, frame_path(sequence, position), load, target))
        for (target, position), load in zip(pending.items(), loaders, strict=True)
    )
    with closing(finished(jobs, workers or _workers(first))) as ended:
        for done, (target, future) in enumerate(ended, len(skipped) + 1):
            if problem := future.exception():
                if options.overwrite or not target.exists():
                    failures[target] = error_of_file(problem, frame_path(sequence, pending[target]))
                else:
                    elsewhere.append(target)
            show_progress(progress, done, len(targets))
    if failures:
        raise _failure(failures, targets, sequence)
    plates = conversion.plates | {target: plate_of(pending[target]) for target in elsewhere}
    try:
        check_finished(plates.items(), light, options.depth)
    except PlateError as problem:
        if not options.overwrite:
            raise
        raise PlateError("written_meanwhile", path=problem.facts["path"]) from problem
    written = tuple(target for target in pending if target not in elsewhere)
    clipped = float(np.mean([*conversion.clipped.values()] or [0.0]))
    sizes = tuple(sorted(conversion.sizes))
    return PlateReport(written, (*skipped, *sorted(elsewhere)), sequence.missing, light, clipped, sizes)


@dataclass(frozen=True, eq=False)
class _Conversion:
    """The facts that all frames share, such as the meaning of their light and the factor of the exposure."""

    light: PlateLight
    scale: float
    options: PlateOptions
    first: FirstFrame | None
    plate_of: Callable[[int], str]
    plates: dict[Path, str] = field(default_factory=dict)  # the identity of the plate of each file written
    clipped: dict[Path, float] = field(default_factory=dict)  # the share outside the LUT, of the same
    sizes: set[tuple[int, ...]] = field(default_factory=set)  # their widths and heights

    def write(self, position: int, path: Path, load: FrameLoader, target: Path) -> None:
        """Read one plate and write its linear EXR."""
        frame = self._read(position, path, load)
        pixels = self._linear_pixels(frame)
        plate, depth = self.plate_of(position), self.options.depth
        attributes = {**self.light.attributes, PLATE: plate}
        header = linear_header(frame.header, channels=pixels.shape[2], depth=depth, attributes=attributes)
        with atomic_write(target, overwrite=self.options.overwrite, error=PlateError) as temporary:
            write_exr(temporary, header, pixels, name=target)
        low, high = self.light.lut.domain
        is_coded = frame.samples.dtype.kind == "u"
        self.plates[target] = plate
        self.sizes.add(pixels.shape[1::-1])
        self.clipped[target] = 0.0 if is_coded else float(np.mean((frame.samples < low) | (frame.samples > high)))

    def _read(self, position: int, path: Path, load: FrameLoader) -> EncodedFrame:
        """Return a plate, which must have the primaries and the transfer function of the first."""
        if self.first is None:
            return load()
        if position == self.first.position:
            return self.first.frame
        frame = load()
        tagged, first = (color.transfer or "unknown" for color in (frame.color, self.first.frame.color))
        if tagged != first and not self.options.is_encoded:
            raise PlateError("transfer_differs", path=path, transfer=tagged, first=self.first.path.name, other=first)
        primaries = plate_primaries(frame.color, self.options.primaries)
        check_same_primaries(path, primaries, self.first.path, self.light.plate)
        return frame

    def _linear_pixels(self, frame: EncodedFrame) -> NDArray[Any]:
        """Return matrix @ lut.apply(B) * scale, times coverage, as in OpenEXR, and alpha: (H, W, 3 or 4), to write."""
        height, width, _ = frame.samples.shape
        linear = np.empty((height, width, 3 if frame.alpha is None else 4), SAMPLE_TYPES[self.options.depth])
        peak = 0.0 if frame.alpha is None else float(np.abs(frame.alpha).max())  # OpenEXR does not bound it
        if peak > float(np.finfo(linear.dtype).max):
            raise PlateError("exceeds_half", peak=peak)
        is_coded = frame.samples.dtype.kind == "u"
        codes = np.arange(frame.largest + 1) / frame.largest
        lut, matrix = self.light.lut, self.light.space.matrix
        is_multiplied = frame.alpha is not None and frame.is_coverage
        is_final = matrix is None and not is_multiplied
        table = np.stack([channel.apply(codes) for channel in lut.channels], axis=1)  # (codes, 1 or 3)
        table = (table * self.scale).astype(linear.dtype if is_final else np.float32)
        for top in range(0, height, _ROWS):
            rows = slice(top, top + _ROWS)
            block = frame.samples[rows]  # (_ROWS, W, 3)
            if is_coded:
                values = _look_up(table, block)
            else:
                values = lut.apply(np.minimum(block, lut.domain[1])) * np.float32(self.scale)
            if matrix is not None:
                values = values @ matrix.T.astype(np.float32)
            if frame.alpha is not None:
                alpha = frame.alpha[rows, :, None]
                values = values * alpha if is_multiplied else values
                linear[rows, :, 3:] = alpha
            linear[rows, :, :3] = values
        return linear


def _workers(first: FirstFrame | None) -> int:
    """Return how many frames of the size of the first are linearized at a time."""
    pixels = first.frame.samples[..., 0].size if first else 1
    return max(1, min(cores(), MAX_WORKERS, MAX_PIXELS // pixels))


def finished(
    jobs: Iterable[tuple[Name, Callable[[], None]]], workers: int, *, waiting: int = 2
) -> Generator[tuple[Name, Future[None]]]:
    """Yield named jobs as they finish, in threads; they are taken in this thread, while fewer than `waiting` wait."""
    pool = ThreadPoolExecutor(workers, thread_name_prefix="plate")
    running: dict[Future[None], Name] = {}
    remaining = iter(jobs)
    try:
        while True:
            for name, job in islice(remaining, workers + waiting - len(running)):
                running[pool.submit(job)] = name
            if not running:
                return
            done = wait(running, return_when=FIRST_COMPLETED).done
            yield from [(running.pop(future), future) for future in [*running] if future in done]
    finally:
        pool.shutdown(cancel_futures=True)


def _look_up(table: NDArray[Any], codes: NDArray[Any]) -> NDArray[Any]:
    """Return the entries of codes, shape (..., 3), from a table with one column, or with one for each channel."""
    if table.shape[1] == 1:
        return np.take(table[:, 0], codes)
    return np.stack([np.take(column, codes[..., channel]) for channel, column in enumerate(table.T)], axis=-1)


def _scale(light: PlateLight, options: PlateOptions) -> float:
    """Return the factor of the exposure, after checking that the sample type can hold the linear values."""
    matrix = np.eye(3) if light.space.matrix is None else light.space.matrix
    scale = float(2.0 ** min(light.stops, 1000))  # more would be an OverflowError
    peak = float(np.abs(light.lut.values).max() * np.abs(matrix).sum(axis=1).max()) * scale
    if not 0 < scale < np.inf or not peak <= float(np.finfo(np.float32).max):
        raise PlateError("exposure_out_of_range", stops=light.stops)
    if not peak <= float(np.finfo(SAMPLE_TYPES[options.depth]).max):
        raise PlateError("exceeds_half", peak=peak)
    return scale


def _failure(failures: Mapping[Path, CRFNetError], targets: Sequence[Path], sequence: FrameSource) -> CRFNetError:
    """Return the error that names the frames that failed; for a single file its error."""
    failed = [target for target in targets if target in failures]
    first = failures[failed[0]]
    if not sequence.numbers:
        return first
    numbers = format_frames([n for n, target in zip(sequence.numbers, targets, strict=True) if target in failures])
    others = "; the others are written" if len(failed) < len(targets) else ""
    gaps = f"; missing are {format_frames(sequence.missing)}" if sequence.missing else ""
    facts = {"count": len(failed), "total": len(targets), "frames": numbers, "others": others, "gaps": gaps}
    return PlateError("frames_failed", **facts, first=first)
