"""The OpenEXR file of a linear plate: its header and its pixels."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from crfnet_core.errors import one_line
from crfnet_core.photograph.image_io import first_line, oiio_message
from crfnet_core.photograph.image_io.header_checks import attribute_value

from ..errors import PlateError

#: Metadata that still holds for the linear plate, by OpenImageIO's names. Color profiles do not.
KEPT_METADATA = (
    "DateTime",
    "Exif:ExposureBiasValue",
    "Exif:FocalLength",
    "Exif:ISOSpeedRatings",
    "Exif:LensModel",
    "Exif:PhotographicSensitivity",
    "ExposureTime",
    "FNumber",
    "FramesPerSecond",
    "Make",
    "Model",
    "Orientation",
    "PixelAspectRatio",
    "smpte:KeyCode",
    "smpte:TimeCode",
)

#: OpenEXR's own names of metadata -> OpenImageIO's names of the same, the first that is there, which stay as well. The
#: other standard attributes OpenImageIO names itself: expTime, aperture, capDate, framesPerSecond, timeCode, keyCode.
STANDARD_NAMES = {
    "cameraMake": ("Make",),
    "cameraModel": ("Model",),
    "lensModel": ("Exif:LensModel",),
    "nominalFocalLength": ("Exif:FocalLength",),
    "isoSpeed": ("Exif:PhotographicSensitivity", "Exif:ISOSpeedRatings"),
}

#: The numbers among them, in millimeters and as ISO arithmetic speed.
STANDARD_NUMBERS = ("nominalFocalLength", "isoSpeed")

#: NumPy's types of the two depths.
SAMPLE_TYPES: dict[str, np.dtype[np.floating[Any]]] = {"half": np.dtype(np.float16), "float": np.dtype(np.float32)}


def linear_header(
    source: Any, *, channels: int, depth: str, attributes: Mapping[str, str | float | tuple[float, ...]]
) -> Any:
    """Return the header of a linear plate.

    Parameters
    ----------
    source : OpenImageIO.ImageSpec
        The header of the encoded plate; its size, its windows and its `KEPT_METADATA` are taken over.
    channels : int
        3, or 4 with alpha.
    depth : {"half", "float"}
        Sample type.
    attributes : mapping
        What the values mean, by name: a text, a number or several, as in `PlateLight.attributes`.
    """
    header = oiio.ImageSpec(source.width, source.height, channels, depth)
    for name in ("x", "y", "full_x", "full_y", "full_width", "full_height"):
        setattr(header, name, getattr(source, name))
    header.attribute("DateTime", "")  # else OpenImageIO writes the present time, and no two files are the same
    for attribute in source.extra_attribs:
        if attribute.name in KEPT_METADATA:
            # OpenImageIO's Python drops a single integer of 16 bits, such as the sensitivity, if given its type.
            value = attribute_value(source, attribute)
            value = one_line(value) if isinstance(value, str) else value
            header.attribute(attribute.name, "int" if isinstance(value, int) else attribute.type, value)
    header.attribute("compression", "zips")
    for name, value in {**_standard_attributes(header), **attributes}.items():
        if isinstance(value, tuple):
            header.attribute(name, oiio.TypeDesc(f"float[{len(value)}]"), value)
        else:
            header.attribute(name, _text(value))
    return header


def _text(value: Any) -> Any:
    """Return a text without what is not Unicode in it, which OpenImageIO does not take; any other value as it is."""
    return value.encode(errors="replace").decode() if isinstance(value, str) else value


def _standard_attributes(header: Any) -> dict[str, str | float]:
    """Return the metadata in a header that OpenEXR has names of its own for, by these names."""
    found: dict[str, str | float] = {}
    for name, others in STANDARD_NAMES.items():
        value = next((value for other in others if (value := header.getattribute(other))), None)
        if value is not None:
            found[name] = float(value) if name in STANDARD_NUMBERS else str(value)
    return found


def write_exr(path: Path, header: Any, pixels: NDArray[Any], *, name: Path) -> None:
    """Write an OpenEXR file.

    Parameters
    ----------
    path : Path
        The file to be written, usually a temporary one.
    header : OpenImageIO.ImageSpec
        See `linear_header`.
    pixels : ndarray, float16 or float32, shape (H, W, 3 or 4)
        Linear values, multiplied by alpha if there is one.
    name : Path
        What errors call the file.

    Raises
    ------
    PlateError
        If OpenImageIO cannot write it, for example because the disk is full.
    """
    output = oiio.ImageOutput.create(str(path))
    problem = oiio_message()
    if output is None:
        raise PlateError("exr_not_written", path=name, reason=first_line(problem))
    is_written = output.open(str(path), header) and output.write_image(pixels)
    is_closed = output.close()
    problem = oiio_message(output)
    if problem or not (is_written and is_closed):
        raise PlateError("exr_not_written", path=name, reason=first_line(problem))
    _check_chunks(path, name)


def _check_chunks(path: Path, name: Path) -> None:
    """Raise a PlateError unless every chunk of a file can be read: OpenEXR reports no error of its last write."""
    written = oiio.ImageInput.open(str(path))
    is_whole = written is not None and written.read_image() is not None
    problem = oiio_message(written or oiio)
    if problem or not is_whole:
        raise PlateError("exr_not_written", path=name, reason=first_line(problem))
