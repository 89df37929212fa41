"""What a picture is, if it is no photograph in the rendering of a camera.

tagged          encodings with a published curve that the file names: refused
levels          where the darkest, the middle and the brightest samples lie
log_footage     how likely the levels make log footage, and which curves they may have
log_curves      the published curves of log footage, and their names in ACES configs
limited_range   the codes 16 to 235 of video, stored as if they were 0 to 255
recognition     the finding, in words, with what to do
"""

from crfnet_core.photograph.recognition.levels import Levels
from crfnet_core.photograph.recognition.limited_range import is_limited_range
from crfnet_core.photograph.recognition.log_curves import COLOR_SPACES, LogCurve, log_curves
from crfnet_core.photograph.recognition.log_footage import NearCurve, light_error, log_factor, nearest_curves
from crfnet_core.photograph.recognition.recognition import Kind, Recognition, recognize
from crfnet_core.photograph.recognition.tagged import refuse_tagged, tag_refusal

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
    "refuse_tagged",
    "tag_refusal",
]
