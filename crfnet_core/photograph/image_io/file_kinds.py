"""Which format a file has, told from its first bytes; what is refused for its format alone."""

from __future__ import annotations

import struct
from pathlib import Path

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import problems
from crfnet_core.photograph.image_io.camera_raw import is_raw_content, is_raw_name

#: How the files that are read begin.
SIGNATURES = {
    "JPEG": (b"\xff\xd8\xff",),
    "PNG": (b"\x89PNG\r\n\x1a\n",),
    "TIFF": (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"),
    "DPX": (b"SDPX", b"XPDS"),
    "JPEG XL": (b"\xff\x0a", b"\0\0\0\x0cJXL \r\n\x87\n"),
    "JPEG 2000": (b"\0\0\0\x0cjP  \r\n\x87\n", b"\xff\x4f\xff\x51"),
    "BMP": (b"BM",),
}

#: How scene-linear files begin: they are refused.
LINEAR_SIGNATURES = {"OpenEXR": (b"\x76\x2f\x31\x01",), "Radiance HDR": (b"#?RADIANCE", b"#?RGBE")}

#: Brands of ISO/IEC 23008-12 (HEIF) and AVIF, of still pictures; that of Canon's raw CR3.
HEIC_BRANDS = (b"heic", b"heix", b"heim", b"heis", b"hevc", b"hevx")
AVIF_BRANDS = (b"avif", b"avis")
_RAW_BRAND = b"crx "

#: Suffixes of Truevision TGA, which has no signature.
TARGA_SUFFIXES = (".tga", ".icb", ".vda", ".vst")

#: What `_targa_kind` calls a file whose samples are numbers of colours.
_PALETTED_TARGA = "TGA with a palette"

#: Suffixes for which OpenImageIO invents a picture, whatever is in the file.
_NULL_SUFFIXES = (".null", ".nul")

#: Suffixes of HEIC and AVIF.
HEIF_SUFFIXES = (".heic", ".heif", ".hif", ".avif")

#: How the names of photographs usually end, for a folder that is searched for them.
PHOTOGRAPH_SUFFIXES = (
    *(".jpg", ".jpeg", *HEIF_SUFFIXES, ".png", ".tif", ".tiff", ".webp", ".jxl", ".jp2", ".j2k", ".dpx", ".bmp"),
    ".tga",
)

_WANTED = "JPEG, HEIC, PNG, TIFF, WebP, AVIF, JPEG XL, JPEG 2000, DPX, BMP or TGA"
_HEAD = 12


def file_kind(path: Path) -> str:
    """Return the file's format, such as "JPEG", or refuse it.

    Raises
    ------
    PhotoError
        If the file is absent, empty, or of a format that is not read; for scene-linear files, camera raw, GIF and TGA
        with a palette with the reason.
    OSError
        If it cannot be opened.
    """
    if path.is_dir():
        raise PhotoError(f"{path}: is a folder; give a photograph in it")
    if not path.is_file():
        raise PhotoError(f"{path}: there is no such file; check the name")
    with path.open("rb") as file:
        head = file.read(_HEAD)
        brands = head[8:] + file.read(_brands_length(head))
    if not head:
        raise PhotoError(f"{path}: the file is empty; copy it again")
    _check_kind(path, head, brands)
    for kind, signatures in SIGNATURES.items():
        if head.startswith(signatures):
            return kind
    kind = _container_kind(head, brands) or _targa_kind(path)
    if kind == _PALETTED_TARGA:
        raise problems.paletted(path, "a TGA file with a palette")
    if not kind:
        raise PhotoError(f"{path}: is no {_WANTED} file, whatever its name says; save the photograph as one of these")
    return kind


def _check_kind(path: Path, head: bytes, brands: bytes) -> None:
    """Refuse camera raw, scene-linear files and GIF."""
    is_raw_movie = head[4:8] == b"ftyp" and _RAW_BRAND in _split(brands)
    if is_raw_name(path) or is_raw_movie or is_raw_content(path, head):
        raise problems.camera_raw(path)
    if path.suffix.lower() in _NULL_SUFFIXES:
        raise PhotoError(f"{path}: OpenImageIO reads no file of the suffix {path.suffix}; rename it")
    for kind, signatures in LINEAR_SIGNATURES.items():
        if head.startswith(signatures):
            raise problems.linear(path, kind)
    if head.startswith((b"GIF87a", b"GIF89a")):
        raise problems.paletted(path, "GIF")


def _container_kind(head: bytes, brands: bytes) -> str:
    """Return the format of a RIFF or ISO base media file; empty for others, and for movies."""
    if head.startswith(b"RIFF") and head.endswith(b"WEBP"):
        return "WebP"
    names = _split(brands) if head[4:8] == b"ftyp" else ()
    if any(name in AVIF_BRANDS for name in names):
        return "AVIF"
    return "HEIC" if any(name in HEIC_BRANDS for name in names) else ""


def _brands_length(head: bytes) -> int:
    """Return how many bytes of brands follow the first 12 bytes of an ISO base media file."""
    size = struct.unpack(">I", head[:4])[0] if head[4:8] == b"ftyp" else 0
    return int(min(max(size - _HEAD, 0), 1024))


def _split(brands: bytes) -> tuple[bytes, ...]:
    """Return the brands: the major one, then, behind its version, the compatible ones."""
    return tuple(brands[at : at + 4] for at in range(0, len(brands), 4) if at != 4)


def _targa_kind(path: Path) -> str:
    """Return "TGA", `_PALETTED_TARGA`, or "": TGA (Truevision TGA 2.0) is known by suffix and header."""
    if path.suffix.lower() not in TARGA_SUFFIXES:
        return ""
    with path.open("rb") as file:
        header = file.read(18)
    if len(header) < 18:
        return ""
    has_map, kind, width, height, bits = struct.unpack("<xBB9xHHBx", header)
    if not (has_map <= 1 and kind in (1, 2, 3, 9, 10, 11) and width * height > 0 and bits in (8, 15, 16, 24, 32)):
        return ""
    return _PALETTED_TARGA if kind in (1, 9) else "TGA"
