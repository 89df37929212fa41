"""Recognize a file's format by its first bytes, and refuse formats that hold no encoded photograph."""

from pathlib import Path
from typing import BinaryIO

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.metadata.tiff_tags import tiff_directory

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

#: Suffixes of camera raw, whose small preview must not pass for the photograph; how raw files begin that are not plain
#: TIFF: Fujifilm, Olympus, Panasonic, Minolta, Sigma; the brand of Canon's CR3.
RAW_SUFFIXES = (
    *(".3fr", ".ari", ".arw", ".cr2", ".cr3", ".crw", ".dcr", ".dng", ".erf", ".fff", ".iiq", ".kdc", ".mef", ".mos"),
    *(".mrw", ".nef", ".nrw", ".orf", ".pef", ".raf", ".rw2", ".rwl", ".sr2", ".srf", ".srw", ".x3f"),
)
RAW_SIGNATURES, _RAW_BRAND = (b"FUJIFILMCCD", b"IIRO", b"IIRS", b"MMOR", b"IIU\0", b"\0MRM", b"FOVb"), b"crx "

#: Tags of TIFF (TIFF 6.0, DNG 1.7): NewSubfileType (bit 0: a reduced picture), width, SubIFDs, DNGVersion; and others.
_SUBFILE_TYPE, _WIDTH, _SUB_DIRECTORIES, _DNG_VERSION = 254, 256, 330, 50706
FILL_ORDER, EXTRA_SAMPLES = 266, 338

#: Brands of ISO/IEC 23008-12 (HEIF) and AVIF, of still pictures.
HEIC_BRANDS, AVIF_BRANDS = (b"heic", b"heix", b"heim", b"heis", b"hevc", b"hevx"), (b"avif", b"avis")

#: Suffixes of HEIC and AVIF; and how the names of photographs usually end, for a folder that is searched for them.
HEIF_SUFFIXES = (".heic", ".heif", ".hif", ".avif")
PHOTOGRAPH_SUFFIXES = (
    *(".jpg", ".jpeg", *HEIF_SUFFIXES, ".png", ".tif", ".tiff", ".webp", ".jxl", ".jp2", ".j2k", ".dpx", ".bmp"),
)

_HEAD = 12  # bytes by which a format is known


def file_kind(path: Path) -> str:
    """Return the file's format, such as "JPEG"; raise PhotoError for others, and OSError if it cannot be opened."""
    if path.is_dir():
        raise PhotoError("photograph_is_folder", path=path)
    if not path.is_file():
        raise PhotoError("not_a_file" if path.exists() else "no_such_photograph", path=path)
    with path.open("rb") as file:
        head = file.read(_HEAD)
        brands = _brands(head, file) if head[4:8] == b"ftyp" else ()
    if not head:
        raise PhotoError("photograph_is_empty", path=path)
    _check_kind(path, head, brands)
    for kind, signatures in SIGNATURES.items():
        if head.startswith(signatures):
            return kind
    if head.startswith(b"RIFF") and head.endswith(b"WEBP"):
        return "WebP"
    for kind, names in (("AVIF", AVIF_BRANDS), ("HEIC", HEIC_BRANDS)):
        if any(brand in names for brand in brands):
            return kind
    raise PhotoError("not_an_image_file", path=path)


def _check_kind(path: Path, head: bytes, brands: tuple[bytes, ...]) -> None:
    """Refuse camera raw, scene-linear files and GIF."""
    if path.suffix.lower() in RAW_SUFFIXES or _RAW_BRAND in brands or _is_raw(path, head):
        raise PhotoError("camera_raw", path=path)
    for kind, signatures in LINEAR_SIGNATURES.items():
        if head.startswith(signatures):
            raise PhotoError("scene_linear_file", path=path, kind=kind)
    if head.startswith((b"GIF87a", b"GIF89a")):
        raise PhotoError("palette", path=path, kind="GIF")


def _is_raw(path: Path, head: bytes) -> bool:
    """Return whether a file is camera raw, whatever its name; refuse TIFF that may be, as its picture is elsewhere."""
    if head.startswith(RAW_SIGNATURES) or (head[8:10] == b"CR" and head.startswith((b"II*\0", b"MM\0*"))):
        return True
    if not head.startswith(SIGNATURES["TIFF"]):
        return False
    with path.open("rb") as file:
        entries, below = tiff_directory(file), tiff_directory(file, _SUB_DIRECTORIES)
    is_thumbnail = entries.get(_SUBFILE_TYPE, 0) & 1 or below.get(_WIDTH, 0) > entries.get(_WIDTH, 0)
    if _DNG_VERSION not in entries and _SUB_DIRECTORIES in entries and is_thumbnail:
        problem = "its first page is a thumbnail, and the picture below it, in a SubIFD, may be camera raw"
        raise PhotoError("coding_not_read", path=path, kind="TIFF", problem=problem)
    return _DNG_VERSION in entries


def _brands(head: bytes, file: BinaryIO) -> tuple[bytes, ...]:
    """Return the brands of an ISO base media file: the major one, then, behind its version, the compatible ones."""
    length = min(max(int.from_bytes(head[:4], "big") - _HEAD, 0), 1024)
    brands = head[8:] + file.read(length)
    return tuple(brands[at : at + 4] for at in range(0, len(brands), 4) if at != 4)
