"""Camera response estimation from one photograph: numpy and onnxruntime, OpenImageIO only in image_io.py."""

from crfnet_core.emor import EmorBasis
from crfnet_core.errors import CRFNetError
from crfnet_core.estimate import ResponseEstimate, WindowEstimate, estimate_response
from crfnet_core.image_io import read_photo
from crfnet_core.metrics import estimation_error, linearization_error
from crfnet_core.network import ModelConfig, ResponseNetwork
from crfnet_core.photo import Photo
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
    "linearization_error",
    "read_photo",
    "select_windows",
]
