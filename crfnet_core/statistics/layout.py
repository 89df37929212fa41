"""The layout of a window's statistics: named parts of fixed shapes, one behind the other in one vector.

`pack` is for what counts them, `unpack` for what reads them, the network of `training` included: it takes NumPy's
arrays and PyTorch's tensors.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crfnet_core.statistics import channel_equations, edges, gradients, mixing, shading
from crfnet_core.types import Float32Array

#: The shape of each part, in the order of the vector.
SHAPES: dict[str, tuple[int, ...]] = {
    **gradients.SHAPES,
    **edges.SHAPES,
    **channel_equations.SHAPES,
    **mixing.SHAPES,
    **shading.SHAPES,
    **mixing.HALF_RESOLUTION_SHAPES,
}

#: The parts that hold sums under each candidate response, and the part that counts what each is a sum of.
COUNTS_OF = {name: f"{name}_counts" for name in SHAPES if f"{name}_counts" in SHAPES}

_SIZES = [math.prod(shape) for shape in SHAPES.values()]

#: Length of the vector.
LENGTH = sum(_SIZES)


def pack(parts: Mapping[str, NDArray[Any]]) -> Float32Array:
    """Return the statistics, float32 (LENGTH,), of parts by name, of the shapes in `SHAPES`."""
    return np.concatenate([parts[name].ravel() for name in SHAPES]).astype(np.float32)


def unpack(statistics: Any) -> dict[str, Any]:
    """Return the parts by name, each (..., *shape), of an array or a tensor of statistics (..., LENGTH)."""
    leading = tuple(statistics.shape[:-1])
    ends = accumulate(_SIZES)
    return {
        name: statistics[..., end - size : end].reshape(leading + shape)
        for (name, shape), size, end in zip(SHAPES.items(), _SIZES, ends, strict=True)
    }
