"""Read HEIC and AVIF, for which OpenImageIO's wheel has no reader, and BMP and WebP, which it does not read in full.

It ignores the masks of BMP's channels, and of WebP the place of the first frame, or, before version 3.2, EXIF. HEIC is
decoded by pi-heif, the others by Pillow. Both stop at 8 bits of AVIF, and libyuv in Pillow bounds a factor of blue in
limited range, so AVIF of 10 and 12 bits, or not in full range, is decoded by PyAV, which is an optional dependency.
"""

import warnings
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray
from PIL import Image
from PIL.AvifImagePlugin import AvifImageFile
from PIL.BmpImagePlugin import BmpImageFile
from PIL.WebPImagePlugin import WebPImageFile

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io.header_checks import MAX_PIXELS, check_size, damaged, with_segments
from crfnet_core.photograph.image_io.heif_items import decoded_pixels, has_named_items, is_turned
from crfnet_core.photograph.image_io.iso_boxes import find_box
from crfnet_core.photograph.metadata.file_metadata import metadata_of_header
from crfnet_core.photograph.photo import EXIF_TURNS, UPRIGHT, CodeArray, CodeValues, upright
from crfnet_core.photograph.yuv import Coding, rgb_codes

#: Errors of the decoders for damaged files. Their classes are called, as Image.open refuses 200 megapixels.
_DAMAGE = (
    *(EOFError, IndexError, MemoryError, OSError, RuntimeError, StopIteration, SyntaxError, ValueError),
    Image.DecompressionBombError,  # of WebP nevertheless
)

MOST_DECODED = 4 * MAX_PIXELS  # pixels that are decoded for the main picture: of its tiles, and of what they make

#: Marks of a gain map: Apple's auxiliary picture, and the item and brand of ISO 21496-1.
_GAIN_MAPS = (b"urn:com:apple:photo:2020:aux:hdrgainmap", b"tmap")

#: Where a BMP file of version 5 has the place and size of its profile, and the type of color space of an embedded one.
_BMP_PROFILE_AT, _BMP_EMBEDDED = 126, b"DEBM"

#: The fields of CICP, as pi-heif names them.
_CICP = ("color_primaries", "transfer_characteristics", "matrix_coefficients", "full_range_flag")


@dataclass(frozen=True)
class _Picture:
    """A decoded picture: samples (H, W, C) on the scale of `bit_depth`, as stored or upright, and its metadata."""

    samples: NDArray[Any]
    bit_depth: int
    info: Mapping[Any, Any]
    is_associated: bool = False
    is_upright: bool = True  # else EXIF turns it


def read_pillow_file(path: Path, kind: str) -> CodeValues:
    """Return the integer samples of the main picture of a HEIC, AVIF, WebP or BMP file, upright, as RGB in full range.

    The header has the names that OpenImageIO gives to a JPEG's, and `CICP`, four integers. Raises as `read_photo`.
    """
    meta, main = b"", None
    try:
        if kind in ("HEIC", "AVIF"):
            meta = _meta(path)
            main = _opened_heif(path, kind)
        picture = _READERS[kind](path, main)
    except ImportError as problem:
        raise PhotoError("heif_package_missing", path=path, kind=kind, package=problem.name) from None
    except _DAMAGE as problem:
        raise damaged(path, kind, str(problem)) from None
    nclx = main.info.get("nclx_profile") if main else None
    cicp = tuple(int(nclx[name]) for name in _CICP) if nclx else ()
    values = _code_values(picture, kind, cicp)
    turned = is_turned(meta) if kind == "HEIC" else values.metadata.is_turned  # libheif has turned it
    has_gain_map = any(mark in meta for mark in _GAIN_MAPS)
    return replace(values, metadata=replace(values.metadata, has_gain_map=has_gain_map, is_turned=turned))


def _opened_heif(path: Path, kind: str) -> Any:
    """Return the main picture by pi-heif, not yet decoded; None for AVIF that it does not read, but Pillow may."""
    import pi_heif

    with suppress(*_DAMAGE if kind == "AVIF" else ()):
        main = pi_heif.open_heif(path, convert_hdr_to_8bit=False)
        if not len(main):
            raise ValueError("its items are not supported by libheif")
        check_size(path, *main.size)
        return main
    return None


def _meta(path: Path) -> bytes:
    """Return the content of the box `meta`; ValueError if decoders may not see it: it takes hours, or the process."""
    meta = find_box(path, b"meta")
    if decoded_pixels(meta) > MOST_DECODED:
        raise ValueError("its tiles have many more pixels than the picture")
    if not has_named_items(meta):
        raise ValueError("the type of an item is not text")
    return meta


def _heic(_: Path, main: Any) -> _Picture:
    """Return the picture of a HEIC file; libheif turns it upright."""
    samples, info = np.array(main), main.info  # a copy: its memory goes with `main`
    bit_depth = 8 if samples.dtype == np.uint8 else info["bit_depth"]
    if bit_depth > 8:
        samples = samples >> (16 - bit_depth)  # pi-heif shifts the codes up to 16 bits
    return _Picture(np.atleast_3d(samples), bit_depth, info, is_associated=main.premultiplied_alpha)


def _avif(path: Path, main: Any) -> _Picture:
    """Return the picture of an AVIF file as stored, by Pillow, which puts the boxes `irot` and `imir` into EXIF."""
    bit_depth, nclx = (main.info["bit_depth"], main.info.get("nclx_profile")) if main else (8, None)
    is_exact = bit_depth <= 8 and bool(nclx and nclx["full_range_flag"])  # else Pillow's blue is off by up to 13 codes
    with warnings.catch_warnings(action="ignore"), AvifImageFile(path) as image:
        check_size(path, *image.size)
        info = dict(image.info)
        if main and sorted(main.size) != sorted(image.size):
            raise PhotoError("coding_not_read", path=path, kind="AVIF", problem="it is cropped by the box clap")
        if not is_exact and image.mode == "RGBA":
            problem = f"{bit_depth} bits with alpha" if bit_depth > 8 else "limited range with alpha"
            raise PhotoError("coding_not_read", path=path, kind="AVIF", problem=problem)
        samples = np.asarray(image) if is_exact else _deep_avif(path, bit_depth, image.size)
    return _Picture(np.atleast_3d(samples), max(8, bit_depth), info, is_upright=False)


def _webp(path: Path, _: Any) -> _Picture:
    """Return the first frame of a WebP file."""
    with WebPImageFile(path) as image:
        check_size(path, *image.size)
        return _Picture(np.asarray(image), 8, dict(image.info), is_upright=False)


def _bmp(path: Path, _: Any) -> _Picture:
    """Return the picture of a BMP file; refuse a palette other than of all grays, and less than 8 bits."""
    with BmpImageFile(path) as image, path.open("rb") as file:
        check_size(path, *image.size)
        if image.mode in ("1", "P"):
            raise PhotoError("palette", path=path, kind="a BMP file with a palette")
        if "BGR;1" in str(image.tile[0].args):  # BGR;15 and BGR;16
            raise PhotoError("sample_type", path=path, bits=5, kind="uint8")
        head = file.read(_BMP_PROFILE_AT + 8)
        offset, size = (int.from_bytes(head[at : at + 4], "little") for at in (_BMP_PROFILE_AT, _BMP_PROFILE_AT + 4))
        file.seek(14 + offset)
        profile = file.read(min(size, 1 << 24)) if head[70:74] == _BMP_EMBEDDED else b""
        return _Picture(np.atleast_3d(np.asarray(image)), 8, {"icc_profile": profile})


#: The formats that are read here -> their decoders.
_READERS: dict[str, Callable[[Path, Any], _Picture]] = {"HEIC": _heic, "AVIF": _avif, "BMP": _bmp, "WebP": _webp}
PILLOW_KINDS = tuple(_READERS)


def _deep_avif(path: Path, bit_depth: int, size: tuple[int, int]) -> CodeArray:
    """Return the RGB codes of deep AVIF as stored, (H, W, 3), by PyAV; the box's matrix and range come first."""
    try:
        import av
    except ImportError:
        raise PhotoError("deep_avif_package_missing", path=path, bits=bit_depth) from None
    try:
        with av.open(str(path), metadata_errors="replace") as container:
            is_main = av.stream.Disposition.default
            stream = max(container.streams.video, key=lambda each: bool(each.disposition & is_main))
            context = stream.codec_context
            codes = (int(context.colorspace), int(context.color_range)) if context.color_range else ()
            frame = next(container.decode(stream))
    except av.error.PatchWelcomeError as unknown:  # items in several extents
        raise PhotoError("coding_not_read", path=path, kind="AVIF", problem=unknown.strerror) from None
    if (frame.width, frame.height) != size:
        raise PhotoError("coding_not_read", path=path, kind="AVIF", problem=f"{bit_depth} bits in tiles")
    coding = Coding.from_frame(frame, is_still=True, codes=codes)
    if coding is None:
        problem = f"{frame.format.name}, matrix {int(frame.colorspace)} of H.273"
        raise PhotoError("coding_not_read", path=path, kind="AVIF", problem=problem)
    return rgb_codes(frame, coding, 2**bit_depth - 1)


def _code_values(picture: _Picture, kind: str, cicp: tuple[int, ...]) -> CodeValues:
    """Return the upright samples, with a header as OpenImageIO would give it."""
    carried = with_segments(oiio.ImageSpec(), picture.info)
    turn = EXIF_TURNS.get(1 if picture.is_upright else carried.get_int_attribute("Orientation", 1), UPRIGHT)
    samples = upright(picture.samples, turn)
    height, width, channels = samples.shape
    header = oiio.ImageSpec(width, height, channels, samples.dtype.name)
    header.extra_attribs = carried.extra_attribs
    header.alpha_channel = channels - 1 if channels in (2, 4) else -1
    header.attribute("oiio:UnassociatedAlpha", int(not picture.is_associated))
    header.attribute("oiio:BitsPerSample", picture.bit_depth)
    header.attribute("Orientation", 1)
    if cicp:
        header.attribute("CICP", oiio.TypeDesc("int[4]"), cicp)
    metadata = replace(metadata_of_header(header, kind), is_turned=turn != UPRIGHT)
    return CodeValues.from_samples(samples, picture.bit_depth, header, metadata)
