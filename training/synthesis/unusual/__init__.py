"""Pictures that no family of camera responses explains, made of linear light: what an estimate must refuse.

log_curves       the published curves of log footage
encodings        log, near-linear and limited range, messengers; the ordinary picture that the others change
tone_mapping     local and global operators on high-dynamic-range light
view_transforms  Blender's Filmic and AgX
film_scan        negatives with grain and dust
filters          artistic filters, solarization, palettes, false color
graphics         screenshots and drawings
kinds            the list of kinds, each with its reason; windows and whole frames of a kind
"""

from crfnet_core.photograph.recognition import LogCurve
from training.synthesis.unusual.kinds import (
    RECIPES,
    Recipe,
    UnusualKind,
    random_exposure,
    unusual_photo,
    unusual_windows,
)
from training.synthesis.unusual.log_curves import log_curves

__all__ = [
    "RECIPES",
    "LogCurve",
    "Recipe",
    "UnusualKind",
    "log_curves",
    "random_exposure",
    "unusual_photo",
    "unusual_windows",
]
