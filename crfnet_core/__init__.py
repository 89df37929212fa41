"""Estimate a camera's response from one photograph, with numpy and onnxruntime.

estimate       the method: photographs in, response and uncertainty out
photograph     a photograph's code values and metadata, and the one reader of image files
statistics     the windows of a photograph, and what is counted in them
network        the trained network: its folder, its inputs and predictions, pooling
posterior      from the network's evidence and the metadata to the response, its uncertainty and the verdict
response       a monotone response and its inverse, EMoR, metrics
calibration    the response measured from an exposure stack instead
library        responses of one's cameras, kept to be used again
colorimetry    from chromaticities to matrices
files          write a file whole or not at all
errors, types  the errors that a user can fix; names of array types. messages has the sentences of the errors

The names below are the public interface: see docs/API.md. docs/METHOD.md explains the steps and their equations.
Each is imported when it is first used, so that `import crfnet_core` waits neither for NumPy nor for onnxruntime.
"""

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from crfnet_core.errors import CRFNetError
    from crfnet_core.estimate.estimate import ResponseEstimate, WindowEstimate, estimate_response
    from crfnet_core.network import ModelConfig, ResponseNetwork
    from crfnet_core.photograph.image_io import read_photo
    from crfnet_core.photograph.photo import Photo
    from crfnet_core.response.curve import ResponseCurve
    from crfnet_core.response.emor import EmorBasis
    from crfnet_core.response.metrics import estimation_error, linearization_error
    from crfnet_core.statistics.windows import Window, select_windows

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

#: The module of each public name.
_MODULES = {
    "CRFNetError": "errors",
    "EmorBasis": "response.emor",
    "ModelConfig": "network",
    "Photo": "photograph.photo",
    "ResponseCurve": "response.curve",
    "ResponseNetwork": "network",
    "ResponseEstimate": "estimate.result",
    "Window": "statistics.windows",
    "WindowEstimate": "estimate.result",
    "estimate_response": "estimate.estimate",
    "estimation_error": "response.metrics",
    "linearization_error": "response.metrics",
    "read_photo": "photograph.image_io",
    "select_windows": "statistics.windows",
}


def __getattr__(name: str) -> Any:
    """Import a public name, or a module of this package, when it is first used (PEP 562)."""
    if name in __all__:
        found = getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
        globals()[name] = found
        return found
    if not name.startswith("_") and find_spec(f"{__name__}.{name}"):
        return import_module(f"{__name__}.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
