"""The frames of a stack: read, thinned out, and checked against each other."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path

import numpy as np

from crfnet_core.calibration.exposures import ExposureLabel
from crfnet_core.errors import CalibrationError
from crfnet_core.photograph.image_io import read_codes, read_metadata
from crfnet_core.photograph.metadata import FileMetadata
from crfnet_core.photograph.metadata.devices import camera_name
from crfnet_core.photograph.photo import CodeArray
from crfnet_core.types import Float64Array, Progress, show_progress

#: Frames that a stack needs: fewer leave the response and the exposures to explain each other.
LEAST_FRAMES = 4

#: Longest side of the samples in pixels; larger frames are thinned out.
KEPT_SIDE = 3000

#: 8-bit code from which samples that pile up may be white, their least fraction, and the frames in which they have to.
WHITE_FROM, WHITE_FRACTION, WHITE_FRAMES = 236, 0.002, 2

#: Least ratio of a pile to the fraction of the codes next to it, and of the codes further below. Of 90 simulated
#: stacks that clip at code 255 none has such a pile; of 180 that clip at 238 to 254, 175 have.
ABOVE_NEIGHBORS, ABOVE_REST = 1.5, 2.0


@dataclass(frozen=True, eq=False)
class CameraFile:
    """A picture as a camera wrote it."""

    path: Path
    codes: CodeArray  # (H, W, 3): its code values
    metadata: FileMetadata  # the rest of the file's header


@dataclass(frozen=True, eq=False)
class Frame(CameraFile):
    """One frame of a stack; its codes are thinned out."""

    stride: int  # distance of the codes in the file, in both directions
    largest: int  # the largest code that the file can hold
    label: ExposureLabel  # its exposure by EXIF, or with the time that the user states
    is_gray: bool  # whether the three channels are equal everywhere


def read_frames(
    paths: Sequence[Path], seconds: Sequence[float] | None = None, *, progress: Progress | None = None
) -> list[Frame]:
    """Read the frames of one static scene, with stated exposure times if they are given.

    Raise PhotoError if a frame cannot be read, and CalibrationError if there are fewer than `LEAST_FRAMES`, the times
    are not one for each, or the frames differ in what a stack has in common.
    """
    if len(paths) < LEAST_FRAMES:
        for path in paths:
            read_metadata(path)  # refuses a folder, and the name of no file
        raise CalibrationError("few_frames", least=LEAST_FRAMES, count=len(paths))
    times = [None] * len(paths) if seconds is None else seconds
    if len(times) != len(paths):
        raise CalibrationError("times_count", times=len(times), frames=len(paths))
    frames: list[Frame] = []
    for path, time in zip(paths, times, strict=True):
        values = read_codes(path)
        stride = -(-max(values.codes.shape) // KEPT_SIDE)
        codes, label = values.codes[::stride, ::stride].copy(), ExposureLabel.from_header(values.header, time)
        frames.append(Frame(path, codes, values.metadata, stride, values.largest, label, values.is_gray))
        _check_like_first(frames[0], frames[-1])
        show_progress(progress, len(frames), len(paths))
    check_files(frames)
    return frames


def check_files(files: Sequence[CameraFile]) -> None:
    """Refuse files of several cameras, and copies of a picture."""
    for first, second in combinations(files, 2):
        names = {"path": second.path, "first": first.path.name}
        first_camera, camera = (camera_name(each.metadata.make, each.metadata.model) for each in (first, second))
        if camera != first_camera:
            cameras = {"camera": camera or "no camera", "first_camera": first_camera or "no camera"}
            raise CalibrationError("frame_camera", **names, **cameras)
        if np.array_equal(first.codes, second.codes) and np.ptp(first.codes):
            raise CalibrationError("frame_twice", **names)


def white_level(frames: Sequence[Frame]) -> float:
    """Return the code at which the camera clips, as a part of the largest code; 1 if it is within half an 8-bit code.

    Most cameras clip at the largest code, some a little below. Their samples pile up at one code in several frames,
    though the frames are exposed differently: no surface does that. JPEG rings on both sides of it, as far as the
    largest code, where samples pile up again, but less.
    """
    green = [replace(frame, codes=frame.codes[::2, ::2, 1]) for frame in frames]
    steps = [code_steps(frame) for frame in green]
    fractions = np.array([np.bincount(each.ravel(), minlength=256) / each.size for each in steps])  # (T, 256)
    piles = Counter(pile for row in fractions if (pile := _pile(row)))
    step, times = max(piles.items(), key=lambda pile: pile[1], default=(255, 0))
    if times < WHITE_FRAMES or fractions[:, step].max() <= fractions[:, 255].max():
        return 1.0
    piled = np.concatenate([frame.codes[each == step] for frame, each in zip(green, steps, strict=True)])
    return int(np.bincount(piled).argmax()) / frames[0].largest


def code_steps(frame: Frame) -> CodeArray:
    """Return the codes of a frame rounded to 256 steps, of the same shape."""
    if frame.largest == 255:
        return frame.codes
    return ((frame.codes.astype(np.int64) * 255 + frame.largest // 2) // frame.largest).astype(np.uint8)


def _pile(fractions: Float64Array) -> int | None:
    """Return the code below the largest at which samples of one frame pile up, given the fractions of all 256."""
    pile = WHITE_FROM + int(fractions[WHITE_FROM:].argmax())
    if pile == 255 or fractions[pile] < WHITE_FRACTION:
        return None
    near, below = fractions[[pile - 1, pile + 1]].max(), fractions[WHITE_FROM : pile - 2].max(initial=0)
    return pile if fractions[pile] > ABOVE_NEIGHBORS * near and fractions[pile] > ABOVE_REST * below else None


def _check_like_first(first: Frame, frame: Frame) -> None:
    """Refuse a frame whose size or bit depth differs from the first frame's."""
    names = {"path": frame.path, "first": first.path.name}
    size, first_size = (f"{each.metadata.width} x {each.metadata.height}" for each in (frame, first))
    if size != first_size:
        raise CalibrationError("frame_size", **names, size=size, first_size=first_size)
    if frame.largest != first.largest:
        raise CalibrationError("frame_bits", **names)
