# SPDX-License-Identifier: GPL-3.0-or-later
"""Tell footage that has a known log or linear encoding, for which there is nothing to estimate."""

from __future__ import annotations

from pathlib import Path

import OpenImageIO as oiio
import PyOpenColorIO as OCIO

from ..scene.color_management import is_log_or_linear
from ..scene.plates import Plate
from .errors import AddonError

#: Where files say how they are encoded.
_METADATA = ("colorInteropID", "oiio:ColorSpace", "dpx:Transfer")

#: Values of DPX's Transfer that say so.
_DPX_LOG_OR_LINEAR = ("Linear", "Logarithmic", "Printing density", "Z (linear)")

#: What OpenImageIO reports of files that say nothing.
_UNSPECIFIC = ("", "srgb", "srgb_rec709_scene", "rec709")


def check_is_encoded(plate: Plate, file: Path, config: str) -> None:
    """Refuse a plate whose colour space or whose file's metadata says that it is logarithmic or linear.

    Parameters
    ----------
    plate : Plate
        The plate.
    file : Path
        The file, or a frame.
    config : str
        The config that knows the plate's colour space.

    Raises
    ------
    AddonError
        If it does.
    """
    remedy = "there is no response to estimate: choose its colour space in Blender, or tick Estimate Anyway"
    is_a_guess = file.suffix.lower() == ".dpx" and "linear" in plate.color_space.lower()  # Blender's, for every DPX
    if not is_a_guess and is_log_or_linear(plate.color_space, _encoding(plate.color_space, config)):
        raise AddonError(f"{plate.name}: its colour space, {plate.color_space}, is logarithmic or linear, so {remedy}")
    if claim := _claim(file):
        raise AddonError(f"{file.name}: calls itself {claim}, so {remedy}")


def _encoding(color_space: str, config: str) -> str:
    """Return the encoding that the config gives for a colour space, or nothing."""
    try:
        found = OCIO.Config.CreateFromFile(config).getColorSpace(color_space)
    except OCIO.Exception:
        return ""
    return "" if found is None or found.isData() else found.getEncoding() or ""


def _claim(file: Path) -> str:
    """Return the log or linear encoding that a file's metadata names, or nothing; unreadable files are not judged."""
    source = oiio.ImageInput.open(str(file))
    if source is None:
        oiio.geterror()
        return ""
    header = source.spec()
    source.close()
    if header.format.basetype not in (oiio.UINT8, oiio.UINT16):
        return ""
    for name in _METADATA:
        value = header.get_string_attribute(name)
        if name == "dpx:Transfer":
            if value in _DPX_LOG_OR_LINEAR:
                return value
        elif value.lower() not in _UNSPECIFIC and is_log_or_linear(value):
            return value
    return ""
