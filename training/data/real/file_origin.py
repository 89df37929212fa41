"""The original file of a real photograph: its metadata as far as a list has them; whether it was edited or scaled."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum

from crfnet_core.photograph.metadata import FileMetadata
from crfnet_core.photograph.metadata.editors import is_editor
from crfnet_core.photograph.metadata.jpeg import read_jpeg_header
from crfnet_core.photograph.metadata.origin import SCALED_BELOW


class Editing(StrEnum):
    """Whether a program that changes tones saved the file."""

    EDITED = "edited"
    NOT_NAMED = "no editor named"
    UNKNOWN = "not known"


#: Words in `use` of DATA/real_bodies for a file that its publisher developed or edited.
DEVELOPED = "edited/developed by software"


def editing(software: str, *, make: str = "", model: str = "", use: str = "") -> Editing:
    """Return whether a file was edited, from `software`, `make` and `model` in its EXIF and `use` in DATA/real_bodies.

    The name of a program in `software` or `use` decides. Without one, a file that still names the make or the model of
    the camera counts as not edited. A file without them has lost its EXIF to some program, so nothing is known.
    """
    if DEVELOPED in use or is_editor(software):
        return Editing.EDITED
    return Editing.NOT_NAMED if make or model else Editing.UNKNOWN


def is_scaled(size: str) -> bool:
    """Return whether a photograph of "WIDTHxHEIGHT" pixels was made smaller after the camera, by its longest side.

    The lists do not hold the native size of a sensor. The rows of DATA/real_bodies without a crop are just those below
    `SCALED_BELOW`. A camera's own smaller sizes (M, S) stay on the unscaled side, and a compact of 2002 that records
    1024 x 768 falls on the other.
    """
    return max(int(side) for side in size.split("x")) < SCALED_BELOW


def metadata_of_case(row: Mapping[str, str], crop: bytes = b"") -> FileMetadata:
    """Return the metadata of the original file that a row of DATA/real_bodies/cases.csv still knows.

    The row has camera, software, ISO and size. Its crop, a JPEG cut without recompression, has the original's
    quantization tables. The size in EXIF, the profile and the XMP history are lost, except where the photograph is the
    original byte for byte (`is_original`): `read_photo` finds them.
    """
    jpeg = read_jpeg_header(crop)
    width, height = (int(side) for side in row["original_size"].split("x"))
    return FileMetadata(
        width=width,
        height=height,
        make=row["exif_make"].strip(),
        model=row["exif_model"].strip(),
        software=row["exif_software"].strip(),
        iso=round(float(row["iso"])) if row["iso"] else None,
        luma_table=jpeg.luma_table,
        chroma_table=jpeg.chroma_table,
        file_format="JPEG",
    )


def is_original(row: Mapping[str, str]) -> bool:
    """Return whether the photograph of a row is the original file: the larger ones are WebP."""
    return not row["file"].endswith(".webp")
