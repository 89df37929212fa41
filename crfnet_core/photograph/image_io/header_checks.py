"""Check the header of an image file (size, depth, colors), clean its texts, add other segments; errors of decoders."""

import tempfile
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any

import OpenImageIO as oiio
from PIL import Image

from crfnet_core.errors import PhotoError, one_line
from crfnet_core.photograph.metadata.file_metadata import SOFTWARE
from crfnet_core.photograph.metadata.header_colors import INTEROP_INDEX
from crfnet_core.photograph.metadata.tiff_tags import exif_software, interop_index

#: Parts of messages by which decoders refuse sound files of a coding that they do not know.
_UNSUPPORTED = (
    *("support is not configured", "is not implemented", "not supported", "nsupported", "find a format reader"),
    "unhandled critical chunk",  # PNG of Apple's Xcode
    *("not been built in", "Missing or empty image item"),  # HEIF with other codings, and AVIF of items made of others
    *("No support for", "Invalid bits per sample", "Invalid sampleformat"),  # TIFF in Lab, of JPEG with 12 bits, of 9
    "different values per sample",  # TIFF of 5, 6 and 5 bits
    *("components are supported", "exceeds limit"),  # JPEG 2000 of gray and alpha; WebP above Pillow's limit
    "JxlDecoderImageOutBufferSize failed",  # JPEG XL with spot colors, or CMYK
)

MAX_PIXELS = 250_000_000  # of the largest photograph that is read, in at most 5 GB of memory; cameras have 200 million

#: Bytes of the largest JPEG, JPEG 2000 or JPEG XL. They are read as a whole: of mapped files, a bad sector is a SIGBUS.
MOST_CONTENT = 2**30

#: PhotometricInterpretation of TIFF: white or black is zero, RGB, YCbCr; the two of camera raw; a palette; LogLuv.
WHITE_IS_ZERO, READ_PHOTOMETRICS = 0, (0, 1, 2, 6)
RAW_PHOTOMETRICS, PALETTE_PHOTOMETRIC, LINEAR_PHOTOMETRICS = (32803, 34892), 3, (32844, 32845)
MASK = 4
OTHER_PHOTOMETRICS = {MASK: "a mask", 5: "CMYK", 8: "CIE L*a*b*", 9: "CIE L*a*b*", 10: "CIE L*a*b*"}

#: Metadata, as pi-heif and Pillow name it -> the size from which a JPEG cannot carry it; and the beginning of EXIF in a
#: JPEG, which other formats may or may not have.
_MOST_BYTES, _EXIF_NAME = {"exif": 65000, "xmp": 65000, "icc_profile": 1 << 24}, b"Exif\0\0"


def check_size(path: Path, width: int, height: int) -> None:
    """Refuse a picture of more than `MAX_PIXELS`."""
    if width * height > MAX_PIXELS:
        raise PhotoError("too_many_pixels", path=path, width=width, height=height, megapixels=MAX_PIXELS // 10**6)


def checked_bit_depth(path: Path, header: Any, kind: str) -> int:
    """Return the bits per sample, 8, 10, 12, 14 or 16, of an encoded photograph; refuse any other file."""
    check_size(path, header.width, header.height)
    check_size(path, header.tile_width, header.tile_height)  # a tile is decoded as a whole
    if header.depth != 1:
        raise PhotoError("volume", path=path)
    _check_color(path, header, kind)
    sample = str(header.format)
    if sample in ("half", "float", "double"):
        raise PhotoError("scene_linear_file", path=path, kind=f"a file of {sample} samples")
    stored = 8 * header.format.basesize()
    bits = min(header.get_int_attribute("oiio:BitsPerSample", stored), stored)  # XMP may claim more
    if sample not in ("uint8", "uint16") or bits < 8:
        raise PhotoError("sample_type", path=path, bits=bits, kind=sample)
    return bits if bits in (8, 10, 12, 14) else 16


def attributes_of(header: Any) -> Iterator[tuple[str, Any, Any]]:
    """Yield name, type and value of each attribute whose name is printable; others cannot be asked for.

    The `value` of an empty text crashes Blender 4.5, and OpenImageIO's Python drops a single integer of 16 bits if it
    is given its type.
    """
    for attribute in header.extra_attribs:
        if (name := _decoded(partial(getattr, attribute, "name"))).isprintable():
            try:
                value = text_attribute(header, name) if str(attribute.type) == "string" else attribute.value
            except UnicodeDecodeError:  # lists of texts
                continue
            yield name, "int" if isinstance(value, int) and value < 2**31 else attribute.type, value


def channel_names(header: Any) -> tuple[str, ...]:
    """Return the names of the channels in a header."""
    return tuple(_decoded(partial(header.channel_name, channel)) for channel in range(header.nchannels))


def text_attribute(header: Any, name: str) -> str:
    """Return a text in a header, bytes that are not UTF-8 as lone surrogates; empty where it is absent."""
    return str(header.get_bytes_attribute(name).decode(errors="surrogateescape"))


def _decoded(read: Callable[[], Any]) -> str:
    """Return a text of OpenImageIO; bytes that are not UTF-8 become lone surrogates, as from version 3.2 on."""
    try:
        return str(read())
    except UnicodeDecodeError as problem:
        return problem.object.decode(errors="surrogateescape")


def with_plain_texts(header: Any) -> Any:
    """Return a header whose texts are printable."""
    plain = oiio.ImageSpec(header)
    for name, _, value in attributes_of(header):
        if isinstance(value, str) and not value.isprintable():
            plain.attribute(name, one_line(value))
    return plain


def with_segments(header: Any, info: Mapping[Any, Any]) -> Any:
    """Return a header with EXIF, XMP and ICC profile, as OpenImageIO reads and names them in a JPEG with them."""
    complete = oiio.ImageSpec(header)
    if exif := info.get("exif"):
        exif = exif.removeprefix(_EXIF_NAME)
        info = {**info, "exif": (_EXIF_NAME + exif)[: _MOST_BYTES["exif"] - 1]}
        complete.attribute(INTEROP_INDEX, interop_index(BytesIO(exif)))
        complete.attribute(SOFTWARE, exif_software(BytesIO(exif)))
    fitting = {name: info[name] for name, most in _MOST_BYTES.items() if 0 < len(info.get(name) or b"") < most}
    if not fitting:
        return complete
    with tempfile.TemporaryDirectory() as folder:
        carrier = Path(folder, "carrier.jpg")
        Image.new("RGB", (1, 1)).save(carrier, "JPEG", **fitting)
        source = oiio.ImageInput.open(str(carrier))
        oiio_message()
        carried = oiio.ImageSpec() if source is None else with_plain_texts(source.spec())
        if source is not None:
            source.close()
    for name, kind, value in attributes_of(carried):
        if not name.startswith(("jpeg:", "oiio:")):
            complete.attribute(name, kind, value)
    return complete


def _check_color(path: Path, header: Any, kind: str) -> None:
    """Refuse colors other than gray and RGB once decoded without a color conversion, and palettes."""
    photometric = header.get_int_attribute("tiff:PhotometricInterpretation", 2)
    if photometric in RAW_PHOTOMETRICS:
        raise PhotoError("camera_raw", path=path)
    if photometric in LINEAR_PHOTOMETRICS:
        raise PhotoError("scene_linear_file", path=path, kind="LogLuv TIFF")
    if photometric == PALETTE_PHOTOMETRIC or (kind == "PNG" and header.get_int_attribute("png:palette")):
        raise PhotoError("palette", path=path, kind=f"a {kind} file with a palette")
    is_ink = header.get_string_attribute("jpeg:ColorSpace") in ("CMYK", "YCbCrK")
    if is_ink or photometric not in READ_PHOTOMETRICS:
        colors = "CMYK" if is_ink else OTHER_PHOTOMETRICS.get(photometric, f"TIFF photometric {photometric}")
        raise PhotoError("other_colors", path=path, kind=colors)


def damaged(path: Path, kind: str, problem: str) -> PhotoError:
    """Return the error of a file that cannot be decoded, with the first line of the decoder's message."""
    is_unsupported = any(words in problem for words in _UNSUPPORTED)
    code = "coding_not_read" if is_unsupported else "damaged"
    return PhotoError(code, path=path, kind=kind, problem=first_line(problem))


def oiio_message(source: Any = oiio) -> str:
    """Return OpenImageIO's last message, of an open file or else of the library, on plain lines."""
    return "\n".join(map(one_line, _decoded(source.geterror).split("\n")))


def first_line(problem: str) -> str:
    """Return the first line of a decoder's message."""
    return problem.strip().partition("\n")[0] or "no reason is given"
