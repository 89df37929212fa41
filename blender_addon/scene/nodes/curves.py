# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions of colors as RGB Curves nodes, each a table of 256 steps from its Black Level to its White Level.

Where one table is too coarse, several nodes stand side by side and are added: each is 0 below its part of the inputs
and constant above it. The curves of the channels stay straight, so that on the GPU, where tables hold half floats, no
second table adds its error.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING, TypeAlias

import bpy
import numpy as np

from .building import NodeGrid, Socket

if TYPE_CHECKING:
    from crfnet_core import ResponseCurve
    from crfnet_core.types import Float64Array

STEPS = 256  # of the table that Blender makes of a curve; between them it is linear
WHITE, DEEP_WHITE = 255, 65535  # the largest codes of 8 and 16 bits
DARK = 7  # the last code of 8 bits that is too dark for a limit in stops

#: Each code of 9 to 16 bits above `DARK`, in codes of 16 bits.
_DEEP = np.unique(np.concatenate([np.linspace(0, DEEP_WHITE, 2**bits) for bits in range(9, 17)]))
_DEEP = _DEEP[_DEEP > DARK * DEEP_WHITE / WHITE]

#: Largest error of the curves of a deep plate, in stops: with that of half floats on the GPU, it stays below 0.001.
TOLERANCE = 3e-4
_TRIED = 96  # lengths for a part

Part: TypeAlias = tuple[float, float]  # the start and the end of the inputs of one node
EIGHT_BITS: Part = (0, (WHITE + 1) / WHITE)  # of a plate of 8 bits: its table has a step at every code


def add_curves(
    grid: NodeGrid, colors: Socket, function: Callable[[Float64Array], Float64Array], parts: list[Part], column: float
) -> Socket:
    """Return the socket of a function of colors that is 0 at 0, drawn in parts that follow each other from 0 on."""
    total = None
    for row, (start, end) in enumerate(parts):
        node = grid.curve(colors, start, end, column, 1.5 * row)
        values = function(np.linspace(start, end, STEPS + 1))
        _draw(node.mapping, values - values[0])
        drawn = node.outputs[0]
        total = drawn if total is None else grid.add(total, drawn, column + 1, 1.5 * row)
    return total


def deep_parts(curve: ResponseCurve) -> list[Part]:
    """Return the parts in which an inverse response is within `TOLERANCE` on all codes of 9 to 16 bits above `DARK`."""
    light = curve.inverse(_DEEP / DEEP_WHITE)

    def is_close(start: int, end: int) -> bool:
        steps, inside = np.linspace(start, end, STEPS + 1), slice(*np.searchsorted(_DEEP, (start, end)))
        drawn = np.interp(_DEEP[inside], steps, curve.inverse(steps / DEEP_WHITE))
        return bool((abs(np.log2(drawn / light[inside])) <= TOLERANCE).all())

    ends = [0]
    while ends[-1] < DEEP_WHITE:
        start = ends[-1]
        lengths = np.geomspace(DEEP_WHITE - start, 1, _TRIED).round().astype(int).tolist()
        ends.append(start + next((length for length in lengths if is_close(start, start + length)), 1))
    return [(start / DEEP_WHITE, end / DEEP_WHITE) for start, end in pairwise(ends)]


def _draw(mapping: bpy.types.CurveMapping, values: Float64Array) -> None:
    """Draw values at the steps of the table as the curve of all channels; it is constant beyond."""
    mapping.use_clip, mapping.extend = False, "HORIZONTAL"
    points = mapping.curves[3].points
    points[0].location, points[-1].location = (0, values[0]), (1, values[-1])
    for step in range(1, STEPS):
        points.new(step / STEPS, values[step])
    for point in points:
        point.handle_type = "VECTOR"
    mapping.update()
