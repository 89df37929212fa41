"""Read a photograph's code values, upright and otherwise as stored; or its metadata alone."""

import io
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from crfnet_core.errors import PhotoError
from crfnet_core.files import escaped_name
from crfnet_core.photograph.image_io.dpx_files import check_dpx
from crfnet_core.photograph.image_io.file_kinds import EXTRA_SAMPLES, FILL_ORDER, RAW_SUFFIXES, file_kind
from crfnet_core.photograph.image_io.header_checks import (
    MASK,
    WHITE_IS_ZERO,
    checked_bit_depth,
    damaged,
    oiio_message,
    with_plain_texts,
)
from crfnet_core.photograph.image_io.jp2_files import with_jp2_boxes
from crfnet_core.photograph.image_io.jpeg_files import JpegFile, base_image, checked_jpeg
from crfnet_core.photograph.image_io.jxl_files import JxlHeader, jxl_header, with_jxl_boxes
from crfnet_core.photograph.image_io.pillow_files import PILLOW_KINDS, read_pillow_file
from crfnet_core.photograph.image_io.png_files import with_color_chunks
from crfnet_core.photograph.metadata.file_metadata import SOFTWARE, FileMetadata, metadata_of_header
from crfnet_core.photograph.metadata.header_colors import INTEROP_INDEX
from crfnet_core.photograph.metadata.icc import SOURCE
from crfnet_core.photograph.metadata.tiff_tags import exif_software, interop_index, tiff_directory
from crfnet_core.photograph.photo import EXIF_TURNS, UPRIGHT, CodeValues, Photo, Turn, upright

_ROWS, _MOST_PAGES = 256, 64  # rows read at a time, and pages of a TIFF file that are searched for the largest

#: Formats whose pixels alone show whether alpha is associated. DPX does not state it, and OpenImageIO drops the bit of
#: JPEG XL, whose alpha is nearly always straight.
UNSTATED_ALPHA_KINDS = ("DPX", "JPEG XL")

#: By how much colors of straight alpha are above it in some pixels, as a part of white, and the least part of these.
ABOVE_ALPHA, LEAST_ABOVE = 0.05, 0.002


def read_photo(source: str | os.PathLike[str] | bytes | BinaryIO) -> Photo:
    """Return the photograph in an image file of 8 to 16 bits per sample.

    The formats are JPEG, HEIC, PNG, TIFF, WebP, AVIF, JPEG XL, JPEG 2000, DPX and BMP. The values are divided by
    the largest code and turned upright, and nothing else happens to them: no color space, profile or gamma is applied.
    Alpha is dropped, after dividing by it where the file stores associated color. Gray is replicated. Of several frames
    or layers the first is read, of a TIFF file the first of the largest; of an HDR photograph with
    a gain map (Ultra HDR, HEIC) the base picture: `FileMetadata.has_gain_map` is set.

    Parameters
    ----------
    source : str, path-like, bytes or binary file
        The file, its content, or an open file that is read from where it stands. Its beginning decides on the format,
        not its name (except for camera raw).

    Raises
    ------
    PhotoError
        If the file is absent, unreadable, empty, damaged or cut short, of another format, above `MAX_PIXELS`, or not an
        encoded photograph: CMYK, palettes, scene-linear, camera raw.
    """
    if isinstance(source, str | os.PathLike):
        path = Path(os.fsdecode(source))
        return Photo.from_codes(read_codes(path), path)
    name = getattr(source, "name", None)
    path = Path(name) if isinstance(name, str) and name else Path("bytes")
    content: object = source
    if hasattr(source, "read") and not isinstance(source, io.TextIOBase):
        try:
            content = source.read()
        except Exception as problem:  # members of archives and answers of servers raise what they like
            kind = type(problem).__name__
            raise PhotoError("stream_not_read", path=path, kind=kind, problem=problem) from problem
        if not content:
            raise PhotoError("stream_at_end", path=path)
    if not isinstance(content, bytes | bytearray | memoryview):
        raise PhotoError("photograph_source", kind=type(source).__name__)
    return Photo.from_codes(read_content(bytes(content), path), path)


def read_codes(path: str | os.PathLike[str]) -> CodeValues:
    """Return the integer samples of a file; accepts, ignores and raises as `read_photo`, which builds on it."""
    with _opened(Path(path)) as file:
        return file if isinstance(file, CodeValues) else file.codes()


def read_metadata(path: str | os.PathLike[str]) -> FileMetadata:
    """Return the metadata of a file; only of HEIC, AVIF, WebP and BMP the pixels are decoded.

    Raises as `read_photo` does, but does not see damage among the pixels.
    """
    with _opened(Path(path)) as file:
        if isinstance(file, CodeValues):
            return file.metadata
        checked_bit_depth(file.path, file.header, file.kind)
        return file.metadata()


@dataclass(frozen=True)
class _OpenFile:
    """A file that OpenImageIO has opened, at the picture that is read."""

    path: Path
    kind: str
    source: Any
    header: Any
    jpeg: JpegFile | None
    jxl: JxlHeader
    has_gain_map: bool = False

    @property
    def turn(self) -> Turn:
        """The turn of the stored picture, by its orientation."""
        return EXIF_TURNS.get(self.header.get_int_attribute("Orientation", 1), UPRIGHT)

    def metadata(self) -> FileMetadata:
        """Return the metadata of the upright picture."""
        metadata = metadata_of_header(self._upright_header(), self.kind, self.jpeg.metadata if self.jpeg else None)
        has_gain_map = self.has_gain_map or metadata.has_gain_map
        is_turned = self.jxl.orientation > 1 or self.turn != UPRIGHT  # the former by the decoder
        if not self.jxl.has_profile:
            metadata = replace(metadata, color=metadata.color.renamed(SOURCE, "codestream"))
        is_unread = self.jxl.is_unread
        return replace(metadata, is_turned=is_turned, has_gain_map=has_gain_map, is_unread=is_unread)

    def codes(self) -> CodeValues:
        """Return the samples of the upright picture, as three channels and alpha on the file's own scale."""
        bit_depth = checked_bit_depth(self.path, self.header, self.kind)
        values = self._decoded()
        if self.header.get_int_attribute("tiff:PhotometricInterpretation", 1) == WHITE_IS_ZERO:
            wrong = np.s_[..., :1] if bit_depth > 8 else np.s_[..., 1:]  # OpenImageIO inverts all samples of 8 bits
            values[wrong] = ~values[wrong]
        if 8 < bit_depth < 16:
            values = values >> (16 - bit_depth)  # OpenImageIO widens codes to 16 bits and repeats their top bits below
        header = self._upright_header()
        if self.kind in UNSTATED_ALPHA_KINDS and header.alpha_channel > 0:
            is_straight = _is_straight(values, 2**bit_depth - 1)
            if not is_straight and self.kind == "JPEG XL":
                problem = "its colors may be multiplied by alpha"
                raise PhotoError("coding_not_read", path=self.path, kind=self.kind, problem=problem)
            header.attribute("oiio:UnassociatedAlpha", int(is_straight))
        return CodeValues.from_samples(upright(values, self.turn), bit_depth, header, self.metadata())

    def _upright_header(self) -> Any:
        """Return the header of the upright picture: sides and windows are exchanged where rows become columns."""
        header, stored = oiio.ImageSpec(self.header), self.header
        if self.turn[0] == 0:
            header.width, header.height, header.x, header.y = stored.height, stored.width, stored.y, stored.x
            header.full_width, header.full_height = stored.full_height, stored.full_width
            header.full_x, header.full_y = stored.full_y, stored.full_x
        if self.turn != UPRIGHT:
            header.attribute("Orientation", 1)
        return header

    def _decoded(self) -> NDArray[Any]:
        """Return the samples as stored, shape (H, W, C); refuse damage among them."""
        values = _samples(self.source, self.header)
        problem = oiio_message(self.source)
        problem = self.jpeg.damage(problem) if self.jpeg else problem
        if values is None or problem:
            raise damaged(self.path, self.kind, problem)
        return values


@contextmanager
def _opened(path: Path) -> Iterator[_OpenFile | CodeValues]:
    """Yield an open file, or all of it where OpenImageIO does not read it; refusals of the system are a PhotoError."""
    try:
        str(path).encode()  # OpenImageIO takes names as UTF-8
        kind = file_kind(path)
        if kind in PILLOW_KINDS:
            yield read_pillow_file(path, kind)
        else:
            with _opened_kind(path, kind) as file:
                yield file
    except UnicodeEncodeError as problem:
        raise PhotoError("name_not_utf8", path=escaped_name(path)) from problem
    except OSError as problem:
        raise PhotoError("cannot_open_photograph", path=path, problem=problem.strerror) from problem


@contextmanager
def _opened_kind(path: Path, kind: str) -> Iterator[_OpenFile]:
    """Yield an open file of a known format, or refuse it as damaged."""
    jpeg = checked_jpeg(path) if kind == "JPEG" else None
    jxl = jxl_header(path) if kind == "JPEG XL" else JxlHeader()
    hints = oiio.ImageSpec()
    hints.attribute("oiio:UnassociatedAlpha", 1)  # color as stored, not multiplied by alpha
    source = oiio.ImageInput.open(str(path), hints)
    problem = oiio_message()
    if source is None:
        raise damaged(path, kind, problem)
    try:
        if kind == "TIFF":
            _seek_picture(source)
        header = with_plain_texts(source.spec())
        if kind == "TIFF":
            _check_tiff(path, header)
        if kind in ("JPEG 2000", "JPEG XL"):  # OpenImageIO does not say that the second or fourth channel is alpha
            header = with_jp2_boxes(header, path) if kind == "JPEG 2000" else with_jxl_boxes(header, path, jxl)
            header.alpha_channel = header.nchannels - 1 if header.nchannels in (2, 4) else -1
        if kind == "DPX":
            check_dpx(path, header)
        if kind == "JPEG" and str(header.format) == "half":  # Ultra HDR, of which OpenImageIO makes linear light
            with tempfile.TemporaryDirectory() as folder:
                base = Path(folder, "base.jpg")
                base.write_bytes(base_image(path))
                with _opened_kind(base, kind) as file:
                    yield replace(file, path=path, has_gain_map=True)
        else:
            header = with_color_chunks(header, path) if kind == "PNG" else header
            yield _OpenFile(path, kind, source, header, jpeg, jxl)
    finally:
        source.close()


def _check_tiff(path: Path, header: Any) -> None:
    """Refuse deflated bytes of reversed bits; make no alpha of channels of unstated use; add the index of EXIF."""
    with path.open("rb") as file:
        directory = tiff_directory(file)
        header.attribute(INTEROP_INDEX, interop_index(file))
        header.attribute(SOFTWARE, exif_software(file))
    if directory.get(FILL_ORDER) == 2 and header.get_string_attribute("compression") == "zip":
        raise PhotoError("coding_not_read", path=path, kind="TIFF", problem="deflated, with bits in reverse order")
    if header.nchannels > 4 and EXTRA_SAMPLES not in directory:
        header.alpha_channel = -1  # OpenImageIO takes the fourth channel for alpha


def _seek_picture(source: Any) -> None:
    """Go to the first of the largest pages of a TIFF file, without masks: thumbnails, marked or not, are smaller."""
    sizes: list[int] = []
    while len(sizes) < _MOST_PAGES and source.seek_subimage(len(sizes), 0):
        header = source.spec()
        sizes.append(header.image_pixels() * (header.get_int_attribute("tiff:PhotometricInterpretation") != MASK))
    source.seek_subimage(sizes.index(max(sizes)) if sizes else 0, 0)
    oiio_message(source)


def _samples(source: Any, header: Any) -> NDArray[Any] | None:
    """Return the samples of an open file up to alpha, (H, W, C), or None; OpenImageIO copies a picture read at once."""
    channels = min(header.nchannels, max(4, header.alpha_channel + 1))
    if header.tile_width or header.get_string_attribute("planarconfig") == "separate":  # strips may hold a whole plane
        picture: NDArray[Any] | None = source.read_image(source.current_subimage(), 0, 0, channels, header.format)
        return picture
    values = np.empty((header.height, header.width, channels), str(header.format))
    for top in range(0, header.height, _ROWS):
        bottom = min(top + _ROWS, header.height)
        rows = source.read_scanlines(header.y + top, header.y + bottom, header.z, 0, channels, header.format)
        if rows is None:
            return None
        values[top:bottom] = rows
    return values


def _is_straight(samples: NDArray[Any], white: int) -> bool:
    """Return whether colors are not multiplied by alpha, as some are above it, or all of it is opaque."""
    samples = samples[samples[..., -1] < (1 - ABOVE_ALPHA) * white]
    is_above = samples[..., :-1].max(axis=-1, initial=0) > samples[..., -1] + ABOVE_ALPHA * white
    return bool(not samples.size or np.count_nonzero(is_above) > LEAST_ABOVE * len(samples))


def read_content(content: bytes, path: Path) -> CodeValues:
    """Return the integer samples of the content of a file; errors name the path, which need not exist."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, "photograph" + (path.suffix if path.suffix.lower() in RAW_SUFFIXES else ""))
        copy.write_bytes(content)
        try:
            return read_codes(copy)
        except PhotoError as problem:
            raise PhotoError(problem.code, **{**problem.facts, "path": path}) from None
