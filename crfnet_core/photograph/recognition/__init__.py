"""Inputs that are not camera photographs: log footage, limited range, renderings, drawings, sent copies, flat frames.

levels          the darkest, the middle and the brightest samples; limited range; few levels; gray and toned
log_footage     how likely the levels make log footage, and which curves they may have
recognition     the detected kind, in words, with advice; refuses encodings with a published curve
"""

from crfnet_core.photograph.recognition.levels import Levels, is_monochrome
from crfnet_core.photograph.recognition.log_footage import log_factor
from crfnet_core.photograph.recognition.recognition import Kind, Recognition, recognize, refuse_linear, refuse_tagged
from crfnet_core.response.log_curves import COLOR_SPACES, LOG_CURVES

__all__ = ["COLOR_SPACES", "LOG_CURVES", "Kind", "Levels", "Recognition", "is_monochrome", "log_factor", "recognize"]
__all__ += ["refuse_linear", "refuse_tagged"]
