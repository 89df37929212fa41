"""The original file of a real photograph: its metadata as far as a list has them; whether it was edited."""

from __future__ import annotations

from collections.abc import Mapping

from crfnet_core.photograph.metadata import FileMetadata
from crfnet_core.photograph.metadata.editors import is_editor
from crfnet_core.photograph.metadata.jpeg import read_jpeg_header

#: Words in `use` of DATA/real_bodies for a file that its publisher developed or edited.
DEVELOPED = "edited/developed by software"


def is_edited(software: str, use: str) -> bool:
    """Return whether a program that changes tones saved a file, by `software` in its EXIF and `use` in its list."""
    return DEVELOPED in use or is_editor(software)


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
