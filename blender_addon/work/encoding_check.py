# SPDX-License-Identifier: GPL-3.0-or-later
"""Refuse plates that are logarithmic or linear: their encoding is known, so there is no response to estimate."""

from __future__ import annotations

import re
from pathlib import Path

import OpenImageIO as oiio

from crfnet_core.errors import ConfigError
from ocio.configs.files import load_config

from .errors import AddonError
from .job import Plate

#: Metadata that names the encoding of a file, under OpenImageIO's names.
_METADATA = ("colorInteropID", "oiio:ColorSpace", "dpx:Transfer")

#: Values of DPX's Transfer that mean logarithmic or linear.
_DPX_LOG_OR_LINEAR = ("Linear", "Logarithmic", "Printing density", "Z (linear)")

#: What OpenImageIO reports of files without such metadata.
_UNSPECIFIC = ("", "srgb", "srgb_rec709_scene", "rec709")

#: OpenColorIO's encodings of logarithmic and linear colour spaces.
_LOG_OR_LINEAR_ENCODINGS = ("log", "scene-linear", "display-linear")

#: Names of logarithmic and linear colour spaces, for configs that give no encoding.
_LOG_OR_LINEAR_NAME = re.compile(r"linear|^lin_|aces|adx\d|\blog|log\w?\d?\b", re.IGNORECASE)


def check_is_encoded(plate: Plate, file: Path, config: str) -> None:
    """Refuse a plate if its colour space or the metadata of its file says that it is logarithmic or linear.

    Parameters
    ----------
    plate : Plate
        The plate.
    file : Path
        Its file, or one of its frames.
    config : str
        The OpenColorIO config that defines the plate's colour space.

    Raises
    ------
    AddonError
        If the plate is logarithmic or linear.
    """
    remedy = (
        "there is no response to estimate: choose its color space in Blender, or tick Estimate Anyway under Advanced"
    )
    if not _is_guess(plate, file) and is_log_or_linear(plate.color_space, _encoding(plate.color_space, config)):
        raise AddonError(f"{plate.name}: its color space, {plate.color_space}, is logarithmic or linear, so {remedy}")
    if claim := _claim(file):
        raise AddonError(f"{file.name}: calls itself {claim}, so {remedy}")


def is_log_or_linear(color_space: str, encoding: str = "") -> bool:
    """Return whether a colour space is logarithmic or linear: by its encoding in the config, else by its name."""
    if encoding:
        return encoding in _LOG_OR_LINEAR_ENCODINGS
    return bool(_LOG_OR_LINEAR_NAME.search(color_space))


def _is_guess(plate: Plate, file: Path) -> bool:
    """Return whether the colour space is only Blender's guess: it takes every DPX file for linear."""
    return file.suffix.lower() == ".dpx" and "linear" in plate.color_space.lower()


def _encoding(color_space: str, config: str) -> str:
    """Return the encoding of a colour space in a config; empty if the config gives none."""
    try:
        found = load_config(config).getColorSpace(color_space)
    except ConfigError:
        return ""
    return "" if found is None or found.isData() else found.getEncoding() or ""


def _claim(file: Path) -> str:
    """Return the logarithmic or linear encoding that a file's metadata names; empty if none, or if it is unreadable."""
    source = oiio.ImageInput.open(str(file))
    if source is None:
        oiio.geterror()  # else OpenImageIO prints it when the process ends
        return ""
    header = source.spec()
    source.close()
    if header.format.basetype not in (oiio.UINT8, oiio.UINT16):
        return ""
    claims = ((name, header.get_string_attribute(name)) for name in _METADATA)
    return next((value for name, value in claims if _is_log_or_linear_claim(name, value)), "")


def _is_log_or_linear_claim(name: str, value: str) -> bool:
    """Return whether an entry of the metadata means logarithmic or linear."""
    if name == "dpx:Transfer":
        return value in _DPX_LOG_OR_LINEAR
    return value.lower() not in _UNSPECIFIC and is_log_or_linear(value)
