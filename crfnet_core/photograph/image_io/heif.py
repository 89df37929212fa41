"""Read HEIC and AVIF, for which OpenImageIO's wheel has no reader.

HEIC is decoded by pi-heif, and AVIF of 8 bits by Pillow. Both stop at 8 bits of AVIF, so AVIF of 10 and 12 bits is
decoded by PyAV, which is an optional dependency.
"""

from __future__ import annotations

import re
import tempfile
import warnings
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import problems
from crfnet_core.photograph.image_io.header_checks import attribute_value, check_size
from crfnet_core.photograph.metadata.file_metadata import metadata_of_header
from crfnet_core.photograph.orientation import EXIF_TURNS, UPRIGHT, upright
from crfnet_core.photograph.photo import CodeArray, CodeValues
from crfnet_core.photograph.yuv import Coding, rgb_codes

#: EXIF's Orientation.
_ORIENTATION = 0x0112

#: Metadata, as pi-heif and Pillow name it.
_SEGMENTS = ("exif", "xmp", "icc_profile")

#: Errors of the decoders for damaged files.
_DAMAGE = (EOFError, IndexError, MemoryError, OSError, RuntimeError, StopIteration, SyntaxError, ValueError)

#: Bytes at the start of a file in which the boxes `ftyp` and `meta` are looked for (ISO/IEC 14496-12).
_HEAD_BYTES = 1 << 20

#: Marks of a gain map: Apple's auxiliary picture, and the item and brand of ISO 21496-1.
_GAIN_MAPS = (b"urn:com:apple:photo:2020:aux:hdrgainmap", b"tmap")

#: The fields of CICP, as pi-heif names them.
_CICP = ("color_primaries", "transfer_characteristics", "matrix_coefficients", "full_range_flag")


@dataclass(frozen=True)
class _Picture:
    """A decoded picture: samples (H, W, C) on the scale of `bit_depth`, upright, and its metadata by `_SEGMENTS`."""

    samples: NDArray[Any]
    bit_depth: int
    segments: Mapping[str, bytes]
    is_associated: bool = False


def read_heif(path: Path, kind: str) -> CodeValues:
    """Return the integer samples of the main picture of a HEIC or AVIF file, turned upright as the file says.

    Limited range is expanded, and YCbCr turned into RGB by the file's own matrix; the primaries stay as they are. The
    header has the names that OpenImageIO gives to the EXIF, XMP and ICC profile of a JPEG, and `CICP`, four integers.

    Parameters
    ----------
    path : Path
        The file.
    kind : {"HEIC", "AVIF"}
        Its format.

    Raises
    ------
    PhotoError
        If the file is damaged or too large, or the library that decodes it is not installed.
    """
    boxes = _boxes(path)
    if not _has_named_items(boxes):
        raise problems.damaged(path, kind, "the type of an item is no text")
    try:
        import pi_heif

        main = None
        with suppress(*_DAMAGE if kind == "AVIF" else ()):  # Pillow also reads AVIF that pi-heif does not
            main = pi_heif.open_heif(path, convert_hdr_to_8bit=False)
            check_size(path, *main.size)
        info = main.info if main else {}
        picture = _heic(main) if kind == "HEIC" else _avif(path, info.get("bit_depth", 8))
    except ImportError as problem:
        raise PhotoError("heif_package_missing", path=path, kind=kind, package=problem.name) from None
    except _DAMAGE as problem:
        raise problems.damaged(path, kind, str(problem)) from None
    nclx = info.get("nclx_profile")
    cicp = tuple(int(nclx[name]) for name in _CICP) if nclx else ()
    return _code_values(picture, kind, cicp, has_gain_map=any(mark in boxes for mark in _GAIN_MAPS))


def _boxes(path: Path) -> bytes:
    """Return the boxes `ftyp` and `meta`; where the second is not found, the first alone."""
    with path.open("rb") as file:
        head = file.read(_HEAD_BYTES)
    files = head[: int.from_bytes(head[:4])]
    start = max(0, head.find(b"meta", len(files)) - 4)
    return files + (head[start : start + int.from_bytes(head[start : start + 4])] if start else b"")


def _has_named_items(boxes: bytes) -> bool:
    """Return whether the types and names of all items (`infe`) are UTF-8; pi-heif 1.4 ends the process at others."""
    for match in re.finditer(b"infe", boxes):
        end = match.start() - 4 + int.from_bytes(boxes[match.start() - 4 : match.start()])
        entry = boxes[match.end() : end]
        try:
            entry[10 if entry[:1] > b"\2" else 8 :].decode()  # behind the version, the flags and the numbers
        except UnicodeDecodeError:
            return False
    return True


def _heic(main: Any) -> _Picture:
    """Return the picture of a HEIC file; libheif turns it upright."""
    samples, info = np.array(main), main.info  # a copy: its memory goes with `main`
    bit_depth = 8 if samples.dtype == np.uint8 else info["bit_depth"]
    if bit_depth > 8:
        samples = samples >> (16 - bit_depth)  # pi-heif shifts the codes up to 16 bits
    return _Picture(
        samples=np.atleast_3d(samples),
        bit_depth=bit_depth,
        segments=_segments(info),
        is_associated=main.premultiplied_alpha,
    )


def _avif(path: Path, bit_depth: int) -> _Picture:
    """Return the picture of an AVIF file, turned upright."""
    from PIL import Image

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # `check_size` has its own limit
        with Image.open(path, formats=["AVIF"]) as image:
            check_size(path, *image.size)
            exif, info = Image.Exif(), dict(image.info)
            exif.load(info.get("exif", b""))  # `image.getexif` also believes XMP; Pillow puts `irot` and `imir` here
            samples = np.asarray(image) if bit_depth <= 8 else _deep_avif(path, bit_depth, image.size)
    turn = EXIF_TURNS.get(exif.get(_ORIENTATION, 1), UPRIGHT)
    return _Picture(upright(np.atleast_3d(samples), turn), max(8, bit_depth), _segments(info))


def _segments(info: Mapping[Any, Any]) -> dict[str, bytes]:
    """Return the metadata that pi-heif or Pillow found, as `_SEGMENTS` names it."""
    return {name: info[name] for name in _SEGMENTS if info.get(name)}


def _deep_avif(path: Path, bit_depth: int, size: tuple[int, int]) -> CodeArray:
    """Return the RGB codes of an AVIF file of 10 or 12 bits as stored, shape (H, W, 3), decoded by PyAV.

    Matrix and range are those of the file's box, which FFmpeg puts into the stream; a frame has those of its header.
    """
    try:
        import av
    except ImportError:
        raise PhotoError("deep_avif_package_missing", path=path, bits=bit_depth) from None
    with av.open(str(path), metadata_errors="replace") as container:
        context = container.streams.video[0].codec_context
        nclx = (int(context.colorspace), int(context.color_range) == 2) if context.color_range else None
        frame = next(container.decode(video=0))
    if (frame.width, frame.height) != size:
        raise PhotoError("deep_avif_tiles", path=path, bits=bit_depth)
    coding = Coding.from_frame(frame, is_still=True, nclx=nclx)
    if coding is None:
        raise PhotoError("deep_avif_coding", path=path, samples=frame.format.name, matrix=int(frame.colorspace))
    return rgb_codes(frame, coding, 2**bit_depth - 1)


def _code_values(picture: _Picture, kind: str, cicp: tuple[int, ...], *, has_gain_map: bool) -> CodeValues:
    """Return the samples as three channels and alpha, with a header as OpenImageIO would give it."""
    samples, channels = picture.samples, picture.samples.shape[2]
    header = _header(picture, cicp)
    has_alpha = channels in (2, 4)
    is_associated = picture.is_associated and has_alpha
    alpha = ("multiplied" if is_associated else "straight") if has_alpha else ""
    metadata = replace(metadata_of_header(header, kind), has_gain_map=has_gain_map, alpha=alpha)
    return CodeValues(
        codes=samples[..., :3] if channels >= 3 else np.repeat(samples[..., :1], 3, axis=2),
        alpha=samples[..., -1] if has_alpha else None,
        bit_depth=picture.bit_depth,
        is_associated=is_associated,
        header=header,
        metadata=metadata,
    )


def _header(picture: _Picture, cicp: tuple[int, ...]) -> Any:
    """Return an OpenImageIO header with the metadata; the picture is upright, so its orientation is 1."""
    height, width, channels = picture.samples.shape
    header = oiio.ImageSpec(width, height, channels, picture.samples.dtype.name)
    for name, kind, value in _segment_attributes(picture):
        if not name.startswith(("jpeg:", "oiio:")):
            if isinstance(value, str):  # EXIF may hold other bytes than UTF-8, which OpenImageIO gives as surrogates
                value = value.encode(errors="replace").decode()
            header.attribute(name, kind, value)
    header.attribute("oiio:BitsPerSample", picture.bit_depth)
    header.attribute("Orientation", 1)
    if cicp:
        header.attribute("CICP", oiio.TypeDesc("int[4]"), cicp)
    return header


def _segment_attributes(picture: _Picture) -> list[tuple[str, Any, Any]]:
    """Return name, type and value of what OpenImageIO reads in EXIF, XMP and ICC profile.

    A JPEG of one pixel carries them, so the names are those that a JPEG of the same camera gives. What does not fit
    into a JPEG's segments is left out.
    """
    from PIL import Image

    fitting = {name: content for name, content in picture.segments.items() if len(content) < _most_bytes(name)}
    if not fitting:
        return []
    with tempfile.TemporaryDirectory() as folder:
        carrier = Path(folder, "carrier.jpg")
        Image.new("RGB", (1, 1)).save(carrier, "JPEG", **fitting)
        source = oiio.ImageInput.open(str(carrier))
        problems.oiio_message()
        if not source:
            return []
        header = source.spec()
        source.close()
    return [(each.name, each.type, attribute_value(header, each)) for each in header.extra_attribs]


def _most_bytes(segment: str) -> int:
    """Return the size from which a JPEG cannot carry a segment; ICC profiles go into many."""
    return 1 << 24 if segment == "icc_profile" else 65000
