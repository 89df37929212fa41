"""Encodings with a published curve that a file calls by name: log of cinema cameras and film scans, PQ and HLG."""

from __future__ import annotations

import re
from dataclasses import replace

from crfnet_core.photograph.metadata.color_tags import ColorTags

#: What follows of transfer characteristics in a DPX header (SMPTE ST 268).
DPX_TRANSFERS = {"Printing density": "Cineon log", "Logarithmic": "log"}

#: Words of an ICC profile's description, in lower case -> the encoding that it names. What is more special comes first.
#: A name may end at an underscore, which is no end of a word to `\b`.
PROFILE_TRANSFERS = (
    (r"\bs-?log ?3", "Sony S-Log3"),
    (r"\bs-?log ?2", "Sony S-Log2"),
    (r"\bs-?log(?![a-z0-9])", "Sony S-Log"),
    (r"\blog ?c ?4", "ARRI LogC4"),
    (r"\blog ?c(?: ?3)?(?![a-z0-9])", "ARRI LogC3"),
    (r"\b(?:canon|c)-? ?log ?3", "Canon Log 3"),
    (r"\b(?:canon|c)-? ?log ?2", "Canon Log 2"),
    (r"\b(?:canon|c)-? ?log(?![a-z0-9])", "Canon Log"),
    (r"\bv-?log", "Panasonic V-Log"),
    (r"log3g10", "RED Log3G10"),
    (r"log3g12", "RED Log3G12"),
    (r"\bd-?log(?![a-z0-9])", "DJI D-Log"),
    (r"\bapple ?log", "Apple Log"),
    (r"\bf-?log ?2", "Fujifilm F-Log2"),
    (r"\bf-?log(?![a-z0-9])", "Fujifilm F-Log"),
    (r"\bn-?log", "Nikon N-Log"),
    (r"\bblackmagic.*film|\bbmdfilm", "Blackmagic Film Gen 5"),
    (r"\bcineon|\bprinting density", "Cineon log"),
    (r"\blogarithmic", "log"),
    (r"\bpq(?![a-z0-9])|\bst ?2084", "PQ"),
    (r"\bhlg(?![a-z0-9])|\bhybrid log", "HLG"),
)

#: ffmpeg writes this into every DPX, and Blender into every one that it does not write as log, whatever the frame is.
_MEANINGLESS_DPX_TRANSFER = "Linear"


def with_named_transfer(color: ColorTags, dpx: str, profile: str) -> ColorTags:
    """Return colour tags with the encoding that DPX's header or the name of an ICC profile says, unless they have one.

    Parameters
    ----------
    color : ColorTags
        What ICC profile, CICP and EXIF say by their numbers.
    dpx : str
        The transfer characteristic of a DPX file.
    profile : str
        Description of the ICC profile.
    """
    if color.transfer:
        return color
    if dpx in DPX_TRANSFERS:
        return replace(color, transfer=DPX_TRANSFERS[dpx], source=color.source or f'dpx:Transfer "{dpx}"')
    name = profile_transfer(profile)
    return replace(color, transfer=name, source=color.source or "ICC profile") if name else color


def profile_transfer(profile: str) -> str:
    """Return the encoding that an ICC profile's description, or DPX's transfer characteristic, names; empty if none."""
    text = profile.casefold()
    return next((name for words, name in PROFILE_TRANSFERS if re.search(words, text)), "")


def dpx_transfer(value: str) -> str:
    """Return the transfer characteristic of a DPX file; empty if it is one that programs write into any file."""
    return "" if value == _MEANINGLESS_DPX_TRANSFER else value
