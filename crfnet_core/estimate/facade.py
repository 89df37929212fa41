"""The shortest way from a photograph to its response."""

import os
from functools import cache
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from crfnet_core.estimate.estimate import estimate_response
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.network import ResponseNetwork
from crfnet_core.photograph.image_io import read_photo
from crfnet_core.photograph.photo import Photo
from crfnet_core.posterior import Prior
from crfnet_core.types import Progress

#: Whatever `read_photo` takes; an array of RGB, shape (H, W, 3), or gray, shape (H, W); or a `Photo`.
Photograph = str | os.PathLike[str] | bytes | BinaryIO | NDArray[Any] | Photo

_packaged_network = cache(ResponseNetwork.load)


def estimate(
    *photographs: Photograph,
    prior: Prior | None = None,
    options: AnalysisOptions | None = None,
    progress: Progress | None = None,
) -> ResponseEstimate:
    """Estimate the response of the camera that took one or several photographs, with the packaged network.

    The network is loaded once in a process.

    Parameters
    ----------
    *photographs : str, path-like, bytes, binary file, ndarray or Photo
        Photographs of one camera with the same settings: files as `read_photo` takes them, or arrays of RGB, shape
        (H, W, 3), or gray, shape (H, W), which have no metadata. `Photo.from_array` takes any other array.
    prior, options, progress
        See `estimate_response`.

    Raises
    ------
    CRFNetError
        If a photograph cannot be read or analyzed.

    Examples
    --------
    >>> response = crfnet.estimate("plate01.jpg").curve
    >>> linear = response.inverse(pixels)
    """
    photos = map(_photo, photographs)
    return estimate_response(photos, network=_packaged_network(), prior=prior, options=options, progress=progress)


def _photo(photograph: Photograph) -> Photo:
    """Return a photograph that is given in one of several forms."""
    if isinstance(photograph, Photo):
        return photograph
    if isinstance(photograph, np.ndarray):
        return Photo.from_array(photograph, color_order="RGB" if photograph.ndim > 2 else None)
    return read_photo(photograph)
