"""Read HEIC and AVIF, for which OpenImageIO's wheel has no reader.

HEIC is decoded by pi-heif, and AVIF of 8 bits by Pillow, on which pi-heif builds. Pillow has no more than 8 bits, so
AVIF of 10 and 12 bits is decoded by PyAV, which is an optional dependency.
"""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import problems
from crfnet_core.photograph.image_io.header_checks import check_size
from crfnet_core.photograph.image_io.heif_boxes import HeifProperties, heif_properties
from crfnet_core.photograph.metadata.file_metadata import metadata_of_header
from crfnet_core.photograph.photo import CodeValues

#: EXIF's Orientation, and how each turns the rows and columns as stored: transposed?, rows reversed?, columns reversed?
_ORIENTATION = 0x0112
_TURNS = {
    2: (False, False, True),
    3: (False, True, True),
    4: (False, True, False),
    5: (True, False, False),
    6: (True, False, True),
    7: (True, True, True),
    8: (True, True, False),
}

#: Metadata, as pi-heif and Pillow name it.
_SEGMENTS = ("exif", "xmp", "icc_profile")

#: What the decoders raise for damaged files.
_DAMAGE = (EOFError, IndexError, MemoryError, OSError, RuntimeError, StopIteration, SyntaxError, ValueError)

#: Bytes at the start of a file that hold the boxes which describe the main picture.
_HEAD_BYTES = 1 << 20


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
    with path.open("rb") as file:
        properties = heif_properties(file.read(_HEAD_BYTES))
    check_size(path, properties.width, properties.height)
    if not properties.has_named_items:
        raise problems.damaged(path, kind, "the type of an item is no text")
    try:
        picture = _heic(path) if kind == "HEIC" else _avif(path, properties.bit_depth)
    except ImportError as problem:
        raise PhotoError(f"{path}: {kind} needs the package {problem.name}; pip install 'pi-heif' 'pillow'") from None
    except _DAMAGE as problem:
        raise problems.damaged(path, kind, str(problem)) from None
    return _code_values(picture, kind, properties)


def _heic(path: Path) -> _Picture:
    """Return the picture of a HEIC file; libheif turns it upright."""
    import pi_heif

    main = pi_heif.open_heif(path, convert_hdr_to_8bit=False)
    check_size(path, *main.size)
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
            exif = image.getexif()
            orientation = exif.get(_ORIENTATION, 1)
            samples = np.asarray(image) if bit_depth <= 8 else _deep_avif(path, bit_depth, image.size)
            info = dict(image.info)
    return _Picture(
        samples=_upright(np.atleast_3d(samples), orientation),
        bit_depth=max(8, bit_depth),
        segments=_segments(info),
    )


def _segments(info: Mapping[Any, Any]) -> dict[str, bytes]:
    """Return the metadata that pi-heif or Pillow found, as `_SEGMENTS` names it."""
    return {name: info[name] for name in _SEGMENTS if info.get(name)}


def _deep_avif(path: Path, bit_depth: int, size: tuple[int, int]) -> NDArray[np.uint16]:
    """Return the RGB codes of an AVIF file of 10 or 12 bits as stored, shape (H, W, 3), decoded by PyAV."""
    try:
        import av
    except ImportError:
        raise PhotoError(
            f"{path}: AVIF of {bit_depth} bits needs PyAV: pip install 'av', or save it as 16-bit PNG"
        ) from None
    with av.open(str(path)) as container:
        frame = next(container.decode(video=0))
    if (frame.width, frame.height) != size:
        raise PhotoError(f"{path}: AVIF of {bit_depth} bits in tiles cannot be read; save it as 16-bit PNG")
    return _rgb_codes(frame, bit_depth)


def _rgb_codes(frame: Any, bit_depth: int) -> NDArray[np.uint16]:
    """Return the RGB codes of a decoded frame, shape (H, W, 3): its own matrix and range, full range in the result."""
    rgb = frame.reformat(
        format="rgb48le", src_colorspace=frame.colorspace, src_color_range=frame.color_range, dst_color_range="JPEG"
    )
    wide = rgb.to_ndarray().astype(np.float32)
    codes: NDArray[np.uint16] = np.rint(wide * np.float32((2**bit_depth - 1) / 65535)).astype(np.uint16)
    return codes


def _upright(samples: NDArray[Any], orientation: int) -> NDArray[Any]:
    """Return samples (H, W, C) turned as an EXIF orientation says."""
    is_transposed, are_rows, are_columns = _TURNS.get(orientation, (False, False, False))
    turned = samples.swapaxes(0, 1) if is_transposed else samples
    return np.ascontiguousarray(turned[:: -1 if are_rows else 1, :: -1 if are_columns else 1])


def _code_values(picture: _Picture, kind: str, properties: HeifProperties) -> CodeValues:
    """Return the samples as three channels and alpha, with a header as OpenImageIO would give it."""
    samples, channels = picture.samples, picture.samples.shape[2]
    header = _header(picture, properties)
    has_alpha = channels in (2, 4)
    is_associated = picture.is_associated and has_alpha
    alpha = ("multiplied" if is_associated else "straight") if has_alpha else ""
    metadata = replace(metadata_of_header(header, kind), has_gain_map=properties.has_gain_map, alpha=alpha)
    return CodeValues(
        codes=samples[..., :3] if channels >= 3 else np.repeat(samples[..., :1], 3, axis=2),
        alpha=samples[..., -1] if has_alpha else None,
        bit_depth=picture.bit_depth,
        is_associated=is_associated,
        header=header,
        metadata=metadata,
    )


def _header(picture: _Picture, properties: HeifProperties) -> Any:
    """Return an OpenImageIO header with the metadata; the picture is upright, so its orientation is 1."""
    height, width, channels = picture.samples.shape
    header = oiio.ImageSpec(width, height, channels, picture.samples.dtype.name)
    for attribute in _segment_attributes(picture):
        if not attribute.name.startswith(("jpeg:", "oiio:")):
            header.attribute(attribute.name, attribute.type, attribute.value)
    header.attribute("oiio:BitsPerSample", picture.bit_depth)
    header.attribute("Orientation", 1)
    if properties.cicp is not None:
        header.attribute("CICP", oiio.TypeDesc("int[4]"), properties.cicp)
    return header


def _segment_attributes(picture: _Picture) -> list[Any]:
    """Return what OpenImageIO reads in EXIF, XMP and ICC profile, by way of a JPEG of one pixel that carries them.

    So the names are those that a JPEG of the same camera gives. What does not fit into a JPEG's segments is left out.
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
        attributes = list(source.spec().extra_attribs) if source else []
        if source:
            source.close()
    return attributes


def _most_bytes(segment: str) -> int:
    """Return the size from which a JPEG cannot carry a segment; ICC profiles go into many."""
    return 1 << 24 if segment == "icc_profile" else 65000
