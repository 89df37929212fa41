"""The one reader of image files: a photograph's code values, before any colour management."""

from __future__ import annotations

import mmap
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from crfnet_core.errors import PhotoError
from crfnet_core.metadata.file_metadata import FileMetadata, metadata_of_header
from crfnet_core.metadata.jpeg import JpegHeader, read_jpeg_header
from crfnet_core.photo import CodeValues, Photo

#: Largest photograph that is read, in pixels (200-megapixel cameras fit): at most 4 GB of memory.
MAX_PIXELS = 250_000_000

#: How the files that are read begin.
SIGNATURES = {
    "JPEG": (b"\xff\xd8\xff",),
    "PNG": (b"\x89PNG\r\n\x1a\n",),
    "TIFF": (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"),
    "DPX": (b"SDPX", b"XPDS"),
}

#: How scene-linear files begin: they are refused.
LINEAR_SIGNATURES = {"OpenEXR": (b"\x76\x2f\x31\x01",), "Radiance HDR": (b"#?RADIANCE", b"#?RGBE")}

#: Camera raw: many of these are TIFF files with a small preview in front, which must not be taken for the photograph.
RAW_SUFFIXES = (
    ".3fr .ari .arw .cr2 .cr3 .crw .dcr .dng .erf .fff .iiq .kdc .mef .mos .mrw .nef .nrw .orf .pef .raf .rw2 .rwl"
    " .sr2 .srf .srw .x3f"
)

#: TIFF's PhotometricInterpretation: the two of camera raw, and what is neither gray, RGB, palette nor YCbCr.
RAW_PHOTOMETRIC = (32803, 34892)
OTHER_PHOTOMETRIC = {5: "CMYK", 8: "CIE L*a*b*", 9: "CIE L*a*b*", 10: "CIE L*a*b*"}

_WANTED = "JPEG, PNG, TIFF, WebP or DPX"
_RAW = f"camera raw holds no encoded picture; give the {_WANTED} developed from it"
_END_OF_IMAGE = b"\xff\xd9"


def read_photo(path: str | Path) -> Photo:
    """Return the photograph in a JPEG, PNG, TIFF, WebP or DPX file of 8 to 16 bits per sample.

    Nothing but the division by the largest code happens to the values: no colour space, profile or gamma is applied,
    and the rows and columns stay as stored (EXIF orientation is ignored). Alpha is dropped, after dividing by it where
    the file stores associated colour. Gray is replicated. Of several frames or layers the first is read; of an
    Ultra HDR photograph its standard image, not the gain map.

    Parameters
    ----------
    path : str or Path
        The file; what counts is how it begins, not its suffix (except for the suffixes of camera raw).

    Raises
    ------
    PhotoError
        If the file is absent, unreadable, empty, damaged or cut short, of another format, above `MAX_PIXELS`, or no
        encoded photograph: CMYK, scene-linear, camera raw.
    """
    values = read_codes(path)
    return Photo(
        pixels=values.pixels(),
        bit_depth=values.bit_depth,
        is_gray=values.is_gray,
        path=Path(path),
        metadata=values.metadata,
    )


def read_codes(path: str | Path) -> CodeValues:
    """Return the integer samples of the file; accepts, ignores and raises as `read_photo`, which builds on it."""
    path = Path(path)
    try:
        str(path).encode()  # OpenImageIO takes names as UTF-8
        return _read(path, _kind(path))
    except UnicodeEncodeError as problem:
        raise PhotoError(f"{str(path)!a}: the name is not UTF-8; rename the file or its folder") from problem
    except OSError as problem:
        raise PhotoError(f"{path}: cannot be opened ({problem.strerror}); check its name and permissions") from problem


def _read(path: Path, kind: str) -> CodeValues:
    """Return the integer samples of a file of a known format."""
    jpeg = _checked_jpeg_header(path) if kind == "JPEG" else None
    hints = oiio.ImageSpec()
    hints.attribute("oiio:UnassociatedAlpha", 1)  # colour as stored, not multiplied by alpha
    source = oiio.ImageInput.open(str(path), hints)
    problem = oiio.geterror()
    if source is None:
        raise _damaged(path, kind, problem)
    try:
        header = source.spec()
        if kind == "JPEG" and str(header.format) == "half":
            return _read_base_image(path)
        bit_depth = _checked_bit_depth(path, header)
        values = source.read_image(0, 0, 0, min(header.nchannels, 4), header.format)
        problem = source.geterror()
    finally:
        source.close()
    if values is None or problem:
        raise _damaged(path, kind, problem)
    return _code_values(values, bit_depth, header, metadata_of_header(header, kind, jpeg))


def _kind(path: Path) -> str:
    """Return the file's format, told from its first bytes, or refuse it."""
    if path.is_dir():
        raise PhotoError(f"{path}: is a folder; give the name of one photograph")
    if not path.is_file():
        raise PhotoError(f"{path}: there is no such file; check the name")
    with path.open("rb") as file:
        head = file.read(12)
    if not head:
        raise PhotoError(f"{path}: the file is empty; copy it again")
    if path.suffix.lower() in RAW_SUFFIXES.split():
        raise PhotoError(f"{path}: {_RAW}")
    for kind, signatures in LINEAR_SIGNATURES.items():
        if head.startswith(signatures):
            raise PhotoError(f"{path}: {_linear(kind)}")
    for kind, signatures in SIGNATURES.items():
        if head.startswith(signatures):
            return kind
    if head.startswith(b"RIFF") and head.endswith(b"WEBP"):
        return "WebP"
    raise PhotoError(f"{path}: is no {_WANTED} file, whatever its name says; save the photograph as one of these")


def _damaged(path: Path, kind: str, problem: str) -> PhotoError:
    """Return the error of a file that cannot be decoded, with the first line of OpenImageIO's message."""
    return PhotoError(f"{path}: this {kind} file is damaged or cut short ({first_line(problem)}); copy it again")


def first_line(problem: str) -> str:
    """Return the first line of an OpenImageIO message."""
    return problem.strip().partition("\n")[0] or "OpenImageIO gives no reason"


def _linear(kind: str) -> str:
    """Return why scene-linear files are refused."""
    return (
        f"{kind} holds scene-linear values, in which no camera response is left to estimate;"
        f" give the {_WANTED} that the camera or the raw developer wrote"
    )


def _checked_bit_depth(path: Path, header: Any) -> int:
    """Return the bits per sample after checking that the header describes an encoded photograph."""
    _check_size(path, header.width, header.height)
    if header.depth != 1:
        raise PhotoError(f"{path}: holds a volume; give a flat photograph")
    _check_color(path, header)
    sample = str(header.format)
    if sample in ("half", "float", "double"):
        raise PhotoError(f"{path}: {_linear(f'a file of {sample} samples')}")
    stored = {"uint8": 8, "uint16": 16}.get(sample, 0)
    bits: int = header.get_int_attribute("oiio:BitsPerSample", stored)
    if not stored or bits < 8:
        raise PhotoError(f"{path}: holds {bits}-bit {sample} samples; needs 8 to 16 bits, unsigned: convert it")
    return bits if bits in (8, 10, 12) else 16


def _check_size(path: Path, width: int, height: int) -> None:
    """Refuse a picture of more than `MAX_PIXELS`."""
    if width * height > MAX_PIXELS:
        raise PhotoError(
            f"{path}: claims {width} x {height} pixels; at most {MAX_PIXELS // 10**6} megapixels are read: crop it"
        )


def _check_color(path: Path, header: Any) -> None:
    """Refuse what is neither gray nor RGB once decoded without a colour conversion."""
    photometric = header.get_int_attribute("tiff:PhotometricInterpretation", 2)
    if photometric in RAW_PHOTOMETRIC:
        raise PhotoError(f"{path}: {_RAW}")
    inks = header.get_string_attribute("jpeg:ColorSpace") in ("CMYK", "YCbCrK")
    other = "CMYK" if inks else OTHER_PHOTOMETRIC.get(photometric)
    if other:
        raise PhotoError(
            f"{path}: holds {other}, which hides the camera's response; give the RGB photograph that it came from"
        )


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


def _checked_jpeg_header(path: Path) -> JpegHeader:
    """Refuse a JPEG for what OpenImageIO would not: a huge frame, which opening allocates, and a missing end.

    Where the rest of a file is zeros (a failed download or recovery) the decoder paints gray and does not complain.
    """
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        header = read_jpeg_header(content)
        for width, height in header.sizes:
            _check_size(path, width, height)
        if content.rfind(_END_OF_IMAGE, header.scan) < 0:
            raise _damaged(path, "JPEG", "it has no end marker")
    return header


def _read_base_image(path: Path) -> CodeValues:
    """Return the standard image of an Ultra HDR JPEG, for which OpenImageIO with libultrahdr gives linear half floats.

    The file holds two JPEG pictures; without the second, the gain map, it is an ordinary one.
    """
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        base = content[: content.find(_END_OF_IMAGE, read_jpeg_header(content).scan) + 2]
        if len(base) == len(content):
            raise PhotoError(f"{path}: {_linear('a JPEG file of half samples')}")
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, "base.jpg")
        copy.write_bytes(base)
        return read_codes(copy)
