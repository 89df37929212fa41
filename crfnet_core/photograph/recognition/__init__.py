"""Inputs that are not camera photographs: log footage, limited range, renderings, recompressed copies, flat frames.

tagged          encodings with a published curve that the file names: refused
levels          the darkest, the middle and the brightest samples
limited_range   the codes 16 to 235 of video, stored as 0 to 255
log_footage     how likely the levels make log footage, and which curves they may have
log_curves      the published curves of log footage, and their names in ACES configs
recognition     the detected kind, in words, with advice
"""

from crfnet_core.photograph.recognition.levels import Levels
from crfnet_core.photograph.recognition.limited_range import is_limited_range
from crfnet_core.photograph.recognition.log_curves import COLOR_SPACES, LogCurve, log_curves
from crfnet_core.photograph.recognition.log_footage import NearCurve, light_error, log_factor, nearest_curves
from crfnet_core.photograph.recognition.recognition import Kind, Recognition, recognize
from crfnet_core.photograph.recognition.tagged import refuse_linear, refuse_tagged

__all__ = [
    "COLOR_SPACES",
    "Kind",
    "Levels",
    "LogCurve",
    "NearCurve",
    "Recognition",
    "is_limited_range",
    "light_error",
    "log_curves",
    "log_factor",
    "nearest_curves",
    "recognize",
    "refuse_linear",
    "refuse_tagged",
]
