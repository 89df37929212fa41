"""CRF-net for compositors: a camera's response from one photograph, as LUTs, an OpenColorIO config and linear plates.

This folder is installed as the package `crfnet`: studios call packages of their own `ocio`.

cli           the command `crfnet`, also as `python -m crfnet`
pipeline      the one way from photographs to files, for the command and for the add-on
report        estimates and files in words, as JSON, and as pictures
configs       OpenColorIO configs with a plate's color space
plates        frame sequences, and linear EXR files made of them
movies        movies as sources of frames
luts          the LUT, and its file formats
output_files  which files an estimate writes, and whether they may be written
options       typed options of the pipeline
defaults      constants that several modules share
errors        the errors of this package; messages has their sentences

The names below are the public interface of `crfnet_core`, imported when they are first used: see docs/API.md.
"""

from typing import TYPE_CHECKING, Any

import crfnet_core

if TYPE_CHECKING:
    from crfnet_core import *  # noqa: F403
    from crfnet_core import estimate_photograph as estimate

__all__ = ["estimate"]
__all__ += crfnet_core.__all__


def __getattr__(name: str) -> Any:
    """Import a public name when it is first used (PEP 562)."""
    if name in __all__:
        return getattr(crfnet_core, "estimate_photograph" if name == "estimate" else name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
