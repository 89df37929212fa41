"""Read a photograph's code values, and nothing else done to them; or its metadata alone."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import problems
from crfnet_core.photograph.image_io.file_kinds import file_kind
from crfnet_core.photograph.image_io.header_checks import check_is_encoded, checked_bit_depth
from crfnet_core.photograph.image_io.heif import read_heif
from crfnet_core.photograph.image_io.jpeg_files import base_image, checked_jpeg_header
from crfnet_core.photograph.image_io.png_files import with_color_chunks
from crfnet_core.photograph.metadata.file_metadata import FileMetadata, metadata_of_header
from crfnet_core.photograph.photo import CodeValues, Photo

#: Rows read at a time.
_ROWS = 256

#: The formats that OpenImageIO does not read.
HEIF_KINDS = ("HEIC", "AVIF")


def read_photo(path: str | Path) -> Photo:
    """Return the photograph in an image file of 8 to 16 bits per sample.

    The formats are JPEG, HEIC, PNG, TIFF, WebP, AVIF, JPEG XL, JPEG 2000, DPX, BMP and TGA. Nothing but the division by
    the largest code happens to the values: no colour space, profile or gamma is applied, and the rows and columns stay
    as stored (EXIF orientation is ignored). HEIC and AVIF are turned upright, because there the rotation is a property
    of the picture. Alpha is dropped, after dividing by it where the file stores associated colour. Gray is replicated.
    Of several frames or layers the first is read; of an HDR photograph with a gain map (Ultra HDR, HEIC) the base
    picture: `FileMetadata.has_gain_map` says so.

    Parameters
    ----------
    path : str or Path
        The file; what counts is how it begins, not its suffix (except for those of camera raw and TGA).

    Raises
    ------
    PhotoError
        If the file is absent, unreadable, empty, damaged or cut short, of another format, above `MAX_PIXELS`, or no
        encoded photograph: CMYK, palettes, scene-linear, camera raw.
    """
    return Photo.from_codes(read_codes(path), Path(path))


def read_codes(path: str | Path) -> CodeValues:
    """Return the integer samples of the file; accepts, ignores and raises as `read_photo`, which builds on it."""
    path = Path(path)
    with _named_errors(path):
        kind = file_kind(path)
        return read_heif(path, kind) if kind in HEIF_KINDS else _read(path, kind)


def read_metadata(path: str | Path) -> FileMetadata:
    """Return what a file says beside its pixels, which are decoded of HEIC and AVIF only.

    Raises as `read_photo` does, but does not see damage among the pixels.
    """
    path = Path(path)
    with _named_errors(path):
        kind = file_kind(path)
        if kind in HEIF_KINDS:
            return read_heif(path, kind).metadata
        jpeg = checked_jpeg_header(path) if kind == "JPEG" else None
        with _opened(path, kind) as source:
            header = _header(source, path, kind)
            if _has_gain_map(header, kind):
                return _read_base_image(path).metadata
            checked_bit_depth(path, header)
            check_is_encoded(path, header, kind)
            return metadata_of_header(header, kind, jpeg)


@contextmanager
def _named_errors(path: Path) -> Iterator[None]:
    """Turn what the system refuses about a file, in the block, into a PhotoError."""
    try:
        str(path).encode()  # OpenImageIO takes names as UTF-8
        yield
    except UnicodeEncodeError as problem:
        raise PhotoError(f"{str(path)!a}: the name is not UTF-8; rename the file or its folder") from problem
    except OSError as problem:
        raise PhotoError(f"{path}: cannot be opened ({problem.strerror}); check its name and permissions") from problem


@contextmanager
def _opened(path: Path, kind: str) -> Iterator[Any]:
    """Yield a file of a known format as an OpenImageIO.ImageInput, or refuse it as damaged."""
    hints = oiio.ImageSpec()
    hints.attribute("oiio:UnassociatedAlpha", 1)  # colour as stored, not multiplied by alpha
    source = oiio.ImageInput.open(str(path), hints)
    problem = problems.oiio_message()
    if source is None:
        raise problems.damaged(path, kind, problem)
    try:
        yield source
    finally:
        source.close()


def _header(source: Any, path: Path, kind: str) -> Any:
    """Return the header of an open file."""
    return with_color_chunks(source.spec(), path) if kind == "PNG" else source.spec()


def _has_gain_map(header: Any, kind: str) -> bool:
    """Return whether OpenImageIO would make an HDR picture of an Ultra HDR JPEG."""
    return kind == "JPEG" and str(header.format) == "half"


def _read(path: Path, kind: str) -> CodeValues:
    """Return the integer samples of a file of a known format."""
    jpeg = checked_jpeg_header(path) if kind == "JPEG" else None
    with _opened(path, kind) as source:
        header = _header(source, path, kind)
        if _has_gain_map(header, kind):
            return _read_base_image(path)
        bit_depth = checked_bit_depth(path, header)
        check_is_encoded(path, header, kind)
        values = _samples(source, header)
        problem = problems.oiio_message(source)
    if values is None or problem:
        raise problems.damaged(path, kind, problem)
    return _code_values(values, bit_depth, header, metadata_of_header(header, kind, jpeg))


def _samples(source: Any, header: Any) -> NDArray[Any] | None:
    """Return the samples in an open file, shape (H, W, 1 to 4), or None; whole pictures OpenImageIO holds twice."""
    channels = min(header.nchannels, 4)
    if header.tile_width:
        tiles: NDArray[Any] | None = source.read_image(0, 0, 0, channels, header.format)
        return tiles
    values = np.empty((header.height, header.width, channels), str(header.format))
    for top in range(0, header.height, _ROWS):
        bottom = min(top + _ROWS, header.height)
        rows = source.read_scanlines(header.y + top, header.y + bottom, header.z, 0, channels, header.format)
        if rows is None:
            return None
        values[top:bottom] = rows
    return values


def _code_values(values: NDArray[Any], bit_depth: int, header: Any, metadata: FileMetadata) -> CodeValues:
    """Return OpenImageIO's samples, shape (H, W, 1 to 4), as three channels and alpha on the file's own scale."""
    if bit_depth in (10, 12):
        values = values >> (16 - bit_depth)  # OpenImageIO widens the codes to 16 bits and repeats their top bits below
    has_alpha = 0 < header.alpha_channel < values.shape[2]
    color = values[..., :3] if values.shape[2] >= 3 else np.repeat(values[..., :1], 3, axis=2)
    return CodeValues(
        codes=color,
        alpha=values[..., header.alpha_channel] if has_alpha else None,
        bit_depth=bit_depth,
        is_associated=has_alpha and not header.get_int_attribute("oiio:UnassociatedAlpha"),
        header=header,
        metadata=metadata,
    )


def _read_base_image(path: Path) -> CodeValues:
    """Return the standard image of an Ultra HDR JPEG."""
    base = base_image(path)
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, "base.jpg")
        copy.write_bytes(base)
        try:
            values = read_codes(copy)
        except PhotoError as problem:
            raise PhotoError(str(problem).replace(str(copy), str(path))) from None
    return replace(values, metadata=replace(values.metadata, has_gain_map=True))
