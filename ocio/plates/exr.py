"""The OpenEXR file of a linear plate: its header and its pixels."""

import re
import struct
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from crfnet_core.errors import one_line
from crfnet_core.photograph.image_io import first_line, oiio_message
from crfnet_core.photograph.image_io.header_checks import attributes_of, channel_names
from crfnet_core.types import is_number

from ..errors import PlateError

#: Metadata that still holds for the linear plate, by OpenImageIO's names. Color profiles do not.
COPIED_TEXTS = ("DateTime", "Exif:LensModel", "Make", "Model")
COPIED_NUMBERS = (
    *("Exif:ExposureBiasValue", "Exif:FocalLength", "Exif:ISOSpeedRatings", "Exif:PhotographicSensitivity"),
    *("ExposureTime", "FNumber", "FramesPerSecond", "Orientation", "PixelAspectRatio"),
    *("smpte:KeyCode", "smpte:TimeCode"),
)

#: OpenEXR's names of metadata -> OpenImageIO's names of the same, of which the first present one counts and stays. The
#: other standard attributes OpenImageIO names itself: expTime, aperture, capDate, framesPerSecond, timeCode, keyCode.
STANDARD_NAMES = {
    **{"cameraMake": ("Make",), "cameraModel": ("Model",), "lensModel": ("Exif:LensModel",)},
    **{"nominalFocalLength": ("Exif:FocalLength",)},  # in millimeters
    **{"isoSpeed": ("Exif:PhotographicSensitivity", "Exif:ISOSpeedRatings")},
}

#: NumPy's types of the two depths.
SAMPLE_TYPES: dict[str, np.dtype[np.floating[Any]]] = {"half": np.dtype(np.float16), "float": np.dtype(np.float32)}

#: Our attribute of the form in which a file was written: see `written_form`.
FORM = "crfnet:form"

#: Bytes of a file that hold the whole header.
MOST_HEADER = 2**20

#: An attribute in a header up to its value: name, type and the size of the value.
ATTRIBUTE = re.compile(rb"[^\0]+\0[^\0]+\0(.{4})", re.DOTALL)


def linear_header(
    source: Any, *, channels: int, depth: str, attributes: Mapping[str, str | float | tuple[float, ...]]
) -> Any:
    """Return the header of a linear plate of 3 or 4 channels, with metadata of `source`, the encoded plate."""
    header = oiio.ImageSpec(source.width, source.height, channels, depth)
    for name in ("x", "y", "full_x", "full_y", "full_width", "full_height"):
        setattr(header, name, getattr(source, name))
    header.attribute("DateTime", "")  # else OpenImageIO writes the present time, and no two files are the same
    for name, kind, value in attributes_of(source):
        is_possible = name != "PixelAspectRatio" or is_number(value, least=1e-6, most=1e6)  # FFmpeg's DPX has 0
        if name in (COPIED_TEXTS if isinstance(value, str) else COPIED_NUMBERS) and is_possible:
            header.attribute(name, kind, one_line(value) if isinstance(value, str) else value)
    header.attribute("compression", "zips")
    standard: dict[str, str | float] = {}
    for name, others in STANDARD_NAMES.items():
        found = next((value for other in others if (value := header.getattribute(other))), None)
        if found is not None:
            standard[name] = found if isinstance(found, str) else float(np.ravel(found)[0])
    for name, value in {**standard, **attributes, FORM: written_form(header)}.items():
        if isinstance(value, tuple):
            header.attribute(name, oiio.TypeDesc(f"float[{len(value)}]"), value)
        else:  # OpenImageIO takes nothing that is not Unicode
            header.attribute(name, value.encode(errors="replace").decode() if isinstance(value, str) else value)
    return header


def written_form(header: Any) -> str:
    """Return the size, the channels and the coding of a file; a comp that is written over it may keep attributes."""
    channels = " ".join(channel_names(header))
    return f"{header.width} x {header.height} {channels} {header.format} {header['compression']}"


def write_exr(path: Path, header: Any, pixels: NDArray[Any], *, name: Path) -> None:
    """Write pixels, (H, W, 3 or 4), as an OpenEXR file; raise a PlateError that calls it `name` if it is not whole."""
    output = oiio.ImageOutput.create(str(path))
    problem = oiio_message()
    if output is None:
        raise PlateError("exr_not_written", path=name, reason=first_line(problem))
    if output.open(str(path), header):
        output.write_image(pixels)
    output.close()
    problem = oiio_message(output)
    if problem or not is_whole(path, header):
        raise PlateError("exr_not_written", path=name, reason=first_line(problem or "a part of it is missing"))


def is_whole(path: Path, header: Any) -> bool:
    """Return whether the chunks of a file fill it without a gap: OpenEXR reports no error of its last writes.

    With zips compression each scanline is a chunk: its y, the size of its data, and the data ("OpenEXR File Layout").
    The table of their places is written last, over zeros. zlib verifies the checksum of the last data.
    """
    try:
        with path.open("rb") as file:
            table = _header_end(file.read(MOST_HEADER))
            places = struct.unpack(f"<{header.height}q", _part(file, table, 8 * header.height))
            leaders = [struct.unpack("<ii", _part(file, place, 8)) for place in places]
            ends = [place + 8 + size for place, (_, size) in zip(places, leaders, strict=True)]
            last = _part(file, places[-1] + 8)
        if leaders[-1][1] < header.scanline_bytes():  # else it is stored as it is, since zlib would enlarge it
            zlib.decompress(last)
        is_filled = [table + 8 * header.height, *ends] == [*places, places[-1] + 8 + len(last)]
        return is_filled and [y for y, _ in leaders] == [header.y + row for row in range(header.height)]
    except (OSError, ValueError, struct.error, zlib.error):
        return False


def _part(file: BinaryIO, place: int, size: int = -1) -> bytes:
    """Return `size` bytes of a file from a place on, by default all."""
    file.seek(place)
    return file.read(size)


def _header_end(content: bytes) -> int:
    """Return where the header of an OpenEXR file ends; somewhere else if the header is damaged."""
    position = 8  # after the magic number and the version
    while attribute := ATTRIBUTE.match(content, position):
        position = attribute.end() + int.from_bytes(attribute[1], "little")
    return position + 1  # after the zero that ends the attributes
