"""All statistics of one window (numpy only; the network normalises the sums)."""

from __future__ import annotations

from crfnet_core.statistics.channel_equations import EQUATION_STRIDES, channel_equations
from crfnet_core.statistics.edges import Triples, edge_sums
from crfnet_core.statistics.gradients import STRIDES, gradient_sums, level_histogram
from crfnet_core.statistics.layout import pack
from crfnet_core.statistics.mixing import half_resolution_parts, mixing_parts
from crfnet_core.statistics.sampling import Lines, code_planes
from crfnet_core.statistics.shading import shading_parts
from crfnet_core.types import Float32Array


def window_statistics(window: Float32Array) -> Float32Array:
    """Return the statistics of one window, float32 (LENGTH,); those of several windows add up.

    Parameters
    ----------
    window : ndarray, float32, shape (227, 227, 3)
        Code values in [0, 1]; not changed.

    Returns
    -------
    ndarray
        The parts of `crfnet_core.statistics.layout`, packed: `unpack` gives them back by name.
    """
    planes = code_planes(window)
    lines = Lines.from_planes(planes)
    triples = [Triples.among(lines.samples_in_a_row(stride, 3)) for stride in STRIDES]
    return pack(
        {
            "histogram": level_histogram(planes),
            "gradients": gradient_sums(lines),
            "edges": edge_sums(triples),
            "channel_equations": channel_equations(triples[: len(EQUATION_STRIDES)]),
            **mixing_parts(lines),
            **shading_parts(lines),
            **half_resolution_parts(planes),
        }
    )
