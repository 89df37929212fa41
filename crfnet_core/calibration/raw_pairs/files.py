"""Pairs of a raw file and the JPEG that the camera made of it: found by name, read, and checked to belong together."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from crfnet_core.calibration.exposures import ExposureLabel
from crfnet_core.calibration.frames import CameraFile
from crfnet_core.calibration.raw_pairs.registration import LUMA, Registration, register
from crfnet_core.errors import CalibrationError, PhotoError
from crfnet_core.photograph.camera_raw import RawPicture, read_raw
from crfnet_core.photograph.image_io import PHOTOGRAPH_SUFFIXES, RAW_SUFFIXES, read_codes, read_content
from crfnet_core.photograph.metadata import file_origin

#: Least width in pixels of the JPEG.
LEAST_WIDTH = 480

#: Least correlation of JPEG and raw picture, laid on each other.
LEAST_CORRELATION = 0.94

#: Least part of the raw picture's width that a camera's JPEG shows, and farthest that its center lies from the raw
#: picture's, in half widths.
LEAST_PART, MOST_SHIFT = 0.91, 0.025

#: Stops by which exposure times of one shot differ: one file may name 1/80 s, the other 0.01258 s.
MOST_EXPOSED = 0.25

#: LibRaw writes its name into the header of previews that have none.
_LIBRAW = "dcraw"


@dataclass(frozen=True, eq=False)
class Pair(CameraFile):
    """A raw file, and the picture and metadata of its JPEG, in 8 bits."""

    jpeg: Path | None  # None if the JPEG is the one inside
    raw: RawPicture
    place: Registration
    editor: str  # the program that made the JPEG, if it was not the camera


def find_pairs(paths: Sequence[Path]) -> tuple[tuple[Path, Path | None], ...]:
    """Return each raw file with its JPEG, None if that is inside; a folder stands for the raw files in it.

    A JPEG belongs to the raw file of the same name. One raw file and one JPEG are a pair whatever their names. Raise
    CalibrationError if there is no raw file, or a JPEG without one.
    """
    files = [file for path in paths for file in (sorted(path.iterdir()) if path.is_dir() else [path])]
    raws = list(dict.fromkeys(path for path in files if path.suffix.lower() in RAW_SUFFIXES))
    given = [path for path in paths if not path.is_dir() and path not in raws]
    if not raws:
        raise CalibrationError("no_raw_file", path=paths[0])
    if len(raws) == len(given) == 1:
        return ((raws[0], given[0]),)
    pairs = {raw: _jpeg_of(raw, given) for raw in raws}
    if alone := [path for path in given if path not in pairs.values()]:
        raise CalibrationError("jpeg_without_raw", path=alone[0])
    return tuple(pairs.items())


def read_pair(path: Path, jpeg: Path | None, *, accept_edited: bool = False) -> Pair:
    """Read a pair and find where the JPEG lies in the raw picture. Raise PhotoError or CalibrationError."""
    raw = read_raw(path)
    if jpeg is None and not raw.preview:
        raise CalibrationError("raw_without_jpeg", path=path)
    values = read_codes(jpeg) if jpeg else read_content(raw.preview, Path(f"{path.stem}.jpg"))
    metadata = values.metadata
    if metadata.software.startswith(_LIBRAW):
        metadata = replace(metadata, software="")
    editor = file_origin(metadata).editor or ("" if jpeg else raw.program)
    shown = jpeg or path
    if editor and not accept_edited:
        raise CalibrationError("frame_edited", path=shown, editor=editor)
    if max(values.codes.shape) < LEAST_WIDTH:
        raise CalibrationError("jpeg_too_small", path=shown, least=LEAST_WIDTH)
    seconds = ExposureLabel.from_header(values.header).seconds
    if raw.seconds and seconds and abs(np.log2(seconds / raw.seconds)) > MOST_EXPOSED:
        raise CalibrationError("pair_exposed", path=shown, raw=path.name, seconds=seconds, raw_seconds=raw.seconds)
    codes = (values.codes // ((values.largest + 1) // 256)).astype(np.uint8)
    place = register((raw.light * raw.balance.astype(np.float32)) @ LUMA, codes @ LUMA)
    if place.correlation < LEAST_CORRELATION:
        raise CalibrationError("pair_differs", path=shown, raw=path.name, correlation=place.correlation)
    if np.exp(place.place[:2]).min() < LEAST_PART or np.abs(place.place[3:5]).max() > MOST_SHIFT:
        raise CalibrationError("pair_cropped", path=shown, raw=path.name)
    return Pair(path, codes, metadata, jpeg, raw, place, editor)


def _jpeg_of(raw: Path, given: Sequence[Path]) -> Path | None:
    """Return the photograph with the name of a raw file: among the given ones, or beside it."""
    try:
        beside = sorted(raw.parent.iterdir())
    except OSError as problem:
        raise PhotoError("cannot_open_photograph", path=raw, problem=problem.strerror) from None
    named = [path for path in (*given, *beside) if path.stem.casefold() == raw.stem.casefold()]
    return next((path for path in named if path.suffix.lower() in PHOTOGRAPH_SUFFIXES), None)
