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
files, staging files that appear whole or not at all; locks has the locks between processes
errors, types  the errors that a user can fix; names of array types. messages has the sentences of the errors

The names below are the public interface: see docs/API.md. docs/METHOD.md explains the steps and their equations.
Each is imported when it is first used, so that `import crfnet_core` waits neither for NumPy nor for onnxruntime.
`crfnet.estimate` is called `estimate_photograph` here, where `estimate` is a package.
"""

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from crfnet_core.errors import CRFNetError
    from crfnet_core.estimate.estimate import estimate_response
    from crfnet_core.estimate.facade import estimate as estimate_photograph
    from crfnet_core.estimate.options import AnalysisOptions
    from crfnet_core.estimate.result import ResponseEstimate
    from crfnet_core.network import ResponseNetwork
    from crfnet_core.photograph.image_io import read_photo
    from crfnet_core.photograph.photo import Photo
    from crfnet_core.response.curve import ResponseCurve
    from crfnet_core.response.emor import EmorBasis

__all__ = ["AnalysisOptions", "CRFNetError", "EmorBasis", "Photo", "ResponseCurve", "ResponseEstimate"]
__all__ += ["ResponseNetwork", "estimate_photograph", "estimate_response", "read_photo"]

#: The module of each public name, and its name there.
_PLACES = {
    "AnalysisOptions": ("estimate.options", "AnalysisOptions"),
    "CRFNetError": ("errors", "CRFNetError"),
    "EmorBasis": ("response.emor", "EmorBasis"),
    "Photo": ("photograph.photo", "Photo"),
    "ResponseCurve": ("response.curve", "ResponseCurve"),
    "ResponseEstimate": ("estimate.result", "ResponseEstimate"),
    "ResponseNetwork": ("network", "ResponseNetwork"),
    "estimate_photograph": ("estimate.facade", "estimate"),
    "estimate_response": ("estimate.estimate", "estimate_response"),
    "read_photo": ("photograph.image_io", "read_photo"),
}


def __getattr__(name: str) -> Any:
    """Import a public name, or a module of this package, when it is first used (PEP 562)."""
    if name in _PLACES:
        module, member = _PLACES[name]
        globals()[name] = getattr(import_module(f"{__name__}.{module}"), member)
        return globals()[name]
    if not name.startswith("_") and find_spec(f"{__name__}.{name}"):
        return import_module(f"{__name__}.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
