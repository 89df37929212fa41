"""Estimate a camera's response from one photograph, with numpy and onnxruntime.

analysis             what the network reads in each photograph
estimate             the method on one screen: photographs in, response and uncertainty out
response_estimate    what comes out, and the same as a document for JSON
calibration          the response measured from an exposure stack instead
photo, image_io      a photograph's code values, of a file or an array, and the one reader of image files
metadata             what a file says of how its photograph was made, and of its primaries
colorimetry          from chromaticities to matrices
recognition          log footage, limited range and tags: what is no photograph of a camera
windows              the windows of a photograph that are analysed
statistics           what is counted in a window
network              the trained network: its folder, its inputs and predictions, pooling, uncertainty
emor                 the empirical model of response: weights to curve, curve to weights
response             a strictly monotone response and its inverse
transfer_functions   sRGB and Rec.709, to compare with
metrics              how far an estimate is from the truth
files                write a file whole or not at all
errors, types        the errors that a user can fix; names of array types

The names below are the public interface: see docs/API.md. docs/METHOD.md explains the steps and their equations.
"""

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
