"""Inputs that are not camera photographs: log footage, limited range, renderings, recompressed copies, flat frames.

levels          the darkest, the middle and the brightest samples; the codes 16 to 235 of video, stored as 0 to 255
log_footage     how likely the levels make log footage, and which curves they may have
log_curves      the published curves of log footage, and their names in ACES configs
recognition     the detected kind, in words, with advice; refuses encodings with a published curve
"""

from crfnet_core.photograph.recognition.levels import Levels, is_limited_range
from crfnet_core.photograph.recognition.log_curves import COLOR_SPACES, LOG_CURVES, LogCurve
from crfnet_core.photograph.recognition.log_footage import light_error, log_factor, nearest_curves
from crfnet_core.photograph.recognition.recognition import Kind, Recognition, recognize, refuse_linear, refuse_tagged

__all__ = ["COLOR_SPACES", "LOG_CURVES", "Kind", "Levels", "LogCurve", "Recognition", "is_limited_range", "light_error"]
__all__ += ["log_factor", "nearest_curves", "recognize", "refuse_linear", "refuse_tagged"]
