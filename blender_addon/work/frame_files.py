# SPDX-License-Identifier: GPL-3.0-or-later
"""The frames of a plate as files that the estimator reads: its own, or temporary ones that are removed afterwards."""

import os
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import OpenImageIO as oiio

from crfnet.plates.frame_files import EncodedFrame, FrameLoader, read_color_tags, read_frame
from crfnet.plates.frame_pattern import FramePattern
from crfnet.plates.frames import FrameSequence, find_frames, pattern_frames, sample_frames
from crfnet.plates.primaries import plate_primaries
from crfnet_core.colorimetry import REC709, Primaries
from crfnet_core.errors import CRFNetError
from crfnet_core.photograph.image_io import read_metadata
from crfnet_core.photograph.metadata import file_origin
from crfnet_core.types import Uint8Array

from .errors import AddonError
from .job import Plate


@dataclass(frozen=True)
class PlateFrames(FrameSequence):
    """The files of a plate whose alpha is taken as by its image in Blender; see `Plate.alpha_mode`."""

    alpha_mode: str = ""

    def loaders(self, positions: Sequence[int]) -> Iterator[FrameLoader]:
        """Yield what reads each frame, for positions in `paths`."""
        for position in positions:
            yield partial(read_plate_frame, self.paths[position], self.alpha_mode, is_encoded=self.is_encoded)


def read_plate_frame(path: Path, alpha_mode: str, *, is_encoded: bool = False) -> EncodedFrame:
    """Return the encoded samples of a frame as `read_frame` does, but for its alpha, which is taken as by Blender.

    It is coverage by which the samples are multiplied (PREMUL) or not (STRAIGHT), data (CHANNEL_PACKED) or nothing
    (NONE), whatever the file states.
    """
    is_associated = None if alpha_mode == "" else alpha_mode == "PREMUL"
    frame = read_frame(path, is_encoded=is_encoded, is_associated=is_associated)
    alpha = None if alpha_mode == "NONE" else frame.alpha
    return replace(frame, alpha=alpha, is_coverage=alpha_mode != "CHANNEL_PACKED")


def frames_of(plate: Plate) -> FrameSequence:
    """Return the frames of a plate; the shown frame of a movie, and an image without a file, have a name only.

    Raise PlateError if the plate has files, and they are not found.
    """
    if plate.frame_count:
        return FrameSequence((plate.file.with_name(f"{plate.file.stem}.{plate.shown_frame:04d}.png"),))
    if plate.content is not None:
        return FrameSequence((plate.file,))
    if plate.numbered is not None:
        before, digits, after = plate.numbered
        name = plate.file.with_name(f"{before}{'#' * digits}{after}")  # for messages, as Blender writes it
        return pattern_frames(FramePattern(plate.file.parent, before, digits, after), name=name)
    return find_frames(plate.file)


def primaries_of(plate: Plate, sequence: FrameSequence, *, is_encoded: bool = False) -> Primaries:
    """Return the primaries that a plate is encoded in, by the tags of its first file; Rec.709 without them.

    For `is_encoded` see `encoding_check.is_said_encoded`. Raise CRFNetError or AddonError if the file cannot be read.
    """
    if plate.frame_count:
        return REC709
    with frame_reader(plate) as read:
        (path,) = read(FrameSequence(sequence.paths[:1], sequence.numbers[:1])).paths
        return plate_primaries(read_color_tags(path, is_encoded=is_encoded)).primaries or REC709


def camera_of(plate: Plate) -> str:
    """Return make and model of the camera that a plate's file names; empty if it names none or cannot be read."""
    try:
        with frame_reader(plate) as read:
            (path,) = read(FrameSequence(frames_of(plate).paths[:1])).paths
            return file_origin(read_metadata(path)).camera
    except (AddonError, CRFNetError):
        return ""


def sample(sequence: FrameSequence) -> FrameSequence:
    """Return the frames of a sequence that the response is estimated from, with their numbers."""
    chosen = sample_frames(sequence)
    numbers = dict(zip(sequence.paths, sequence.numbers, strict=True)) if sequence.numbers else {}
    return FrameSequence(chosen, tuple(numbers[path] for path in chosen if numbers))


@contextmanager
def frame_reader(plate: Plate) -> Iterator[Callable[[FrameSequence], FrameSequence]]:
    """Yield a function that returns frames of a plate as files; temporary ones are there until its next call.

    Raise AddonError if they cannot be written, or the plate is a movie of more than 8 bits.
    """
    if plate.content is None and not plate.frame_count:
        yield lambda sequence: sequence
        return
    try:
        temporary = tempfile.TemporaryDirectory(prefix="crf_", ignore_cleanup_errors=True)
    except OSError as problem:
        raise _no_room(plate, problem) from None
    with temporary as folder:
        try:
            yield partial(_written, plate, Path(folder))
        except CRFNetError as problem:  # without the folder
            raise type(problem)(str(problem).replace(f"{folder}{os.sep}", "")) from None


def _written(plate: Plate, folder: Path, sequence: FrameSequence) -> FrameSequence:
    """Return the file of an image that has none of its own: the packed one byte for byte, or a PNG of its codes."""
    if plate.content is None:
        raise AddonError(
            f"{plate.name}: Blender shows movies of more than 8 bits without their code values; open the frames of the"
            " movie as an image sequence"
        )
    path = folder / (sequence.paths[0] if plate.frame_count else plate.file).name
    try:
        if isinstance(plate.content, bytes):
            path.write_bytes(plate.content)
        else:
            _write_png(path, plate.content)
    except OSError as problem:
        raise _no_room(plate, problem) from None
    return replace(sequence, paths=(path,))


def _no_room(plate: Plate, problem: OSError) -> AddonError:
    """Return the error that a temporary file of a plate cannot be written."""
    return AddonError(f"{plate.name}: no temporary file can be written ({problem.strerror}); free some space")


def _write_png(path: Path, codes: Uint8Array) -> None:
    """Write code values unchanged: colors are not multiplied by alpha."""
    buffer = oiio.ImageBuf(codes)
    buffer.specmod().attribute("oiio:UnassociatedAlpha", 1)
    buffer.specmod().attribute("png:compressionLevel", 1)  # the fastest: the file is read once or twice
    if not buffer.write(str(path)):
        raise AddonError(f"{path}: cannot be written ({buffer.geterror()}); free some space, or install Blender again")
