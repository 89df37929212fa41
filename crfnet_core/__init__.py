"""Estimate a camera's response from one photograph, with numpy and onnxruntime.

analysis             what the network reads in each photograph
estimate             the method on one screen: photographs in, response and uncertainty out
response_estimate    what comes out, and the same as a document for JSON
calibration          the response measured from an exposure stack instead
cameras              responses of one's cameras, kept to be used again
photo, image_io      a photograph's code values, of a file or an array, and the one reader of image files
metadata             what a file says of how its photograph was made, and of its primaries
colorimetry          from chromaticities to matrices
recognition          log footage, limited range and tags: what is no photograph of a camera
windows              the windows of a photograph that are analysed
statistics           what is counted in a window
network              the trained network: its folder, its inputs and predictions, pooling
posterior            from the network's evidence and the metadata to the response, its uncertainty and the verdict
emor                 the empirical model of response: weights to curve, curve to weights
response             a strictly monotone response and its inverse
transfer_functions   sRGB and Rec.709, to compare with
metrics              how far an estimate is from the truth
files                write a file whole or not at all
errors, types        the errors that a user can fix; names of array types

The names below are the public interface: see docs/API.md. docs/METHOD.md explains the steps and their equations.
Each is imported when it is first used, so that `import crfnet_core` waits neither for NumPy nor for onnxruntime.
"""

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
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

#: The module of each public name that is not in `crfnet_core.estimate`.
_MODULES = {
    "CRFNetError": "errors",
    "EmorBasis": "emor",
    "ModelConfig": "network",
    "Photo": "photo",
    "ResponseCurve": "response",
    "ResponseNetwork": "network",
    "Window": "windows",
    "estimation_error": "metrics",
    "linearization_error": "metrics",
    "read_photo": "image_io",
    "select_windows": "windows",
}


def __getattr__(name: str) -> Any:
    """Import a public name, or a module of this package, when it is first used (PEP 562)."""
    if name in __all__:
        found = getattr(import_module(f"{__name__}.{_MODULES.get(name, 'estimate')}"), name)
        globals()[name] = found
        return found
    if not name.startswith("_") and find_spec(f"{__name__}.{name}"):
        return import_module(f"{__name__}.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
