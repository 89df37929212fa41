"""Camera response estimation from one photograph: numpy and onnxruntime, OpenImageIO only in photo.py."""

from crfnet_core.emor import EmorBasis
from crfnet_core.errors import CRFNetError
from crfnet_core.estimate import ResponseEstimate, WindowEstimate, estimate_response
from crfnet_core.metrics import estimation_error, linearisation_error
from crfnet_core.network import ModelConfig, ResponseNetwork
from crfnet_core.photo import Photo, read_photo
from crfnet_core.response import ResponseCurve
from crfnet_core.windows import Window, select_windows

__all__ = [
    "CRFNetError",
    "EmorBasis",
    "ModelConfig",
    "Photo",
    "ResponseCurve",
    "ResponseEstimate",
    "ResponseNetwork",
    "Window",
    "WindowEstimate",
    "estimate_response",
    "estimation_error",
    "linearisation_error",
    "read_photo",
    "select_windows",
]
