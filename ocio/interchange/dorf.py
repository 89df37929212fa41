"""The text of DoRF, the Database of Response Functions: a name, a kind of graph, irradiances and brightnesses.

A curve is six lines: its name, the kind of graph, `I =` (or `E =`), irradiances, `B =`, brightnesses; in the files of
inverse responses the two pairs change places. Several curves follow each other.

Source: Grossberg & Nayar, "Modeling the space of camera response functions", TPAMI 2004, and its dorfCurves.txt.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crfnet_core.files import atomic_write_text
from crfnet_core.response.curve import SAMPLES
from crfnet_core.types import Float64Array

from ..errors import LutError
from ..luts.response import brightness_samples
from ..luts.rgb_lut import AnyLut
from ..luts.text import LutText
from .response_file import ResponseFile, from_curve

_HEADING = re.compile(r"([IEB])\s*=")


@dataclass(frozen=True, eq=False)
class DorfCurve:
    """A response as the text has it: its name, the line of its name, irradiances and brightnesses, shape (N,)."""

    name: str
    line: int
    irradiance: Float64Array
    brightness: Float64Array


def read_dorf(path: Path, *, curve: str = "") -> ResponseFile:
    """Return a response of a text file.

    Parameters
    ----------
    path : Path
        The file.
    curve : str
        The name of the curve, or its number from 1; needed where there are several.

    Raises
    ------
    LutError
        If the file is absent or holds no such curve, or the curve is no response.
    """
    source = LutText.read(path)
    curves = _curves(source)
    chosen = _chosen(source, curves, curve)
    order = np.argsort(chosen.irradiance, kind="stable")
    light, brightness = chosen.irradiance[order], chosen.brightness[order]
    if light[0] == light[-1]:
        raise source.error(f"the irradiances of {chosen.name!r} are all the same", line=chosen.line)
    samples = np.interp(np.linspace(light[0], light[-1], SAMPLES), light, brightness)
    return from_curve(path, samples, f"DoRF curve {chosen.name}")


def write_dorf(path: Path, lut: AnyLut, *, overwrite: bool = False) -> tuple[str, ...]:
    """Write the response of an inverse one: a curve of 1024 samples, or one for each of R, G and B.

    Raises
    ------
    LutError
        If the file exists and may not be replaced, or cannot be written.
    """
    names = [path.stem] if len(lut.channels) == 1 else [f"{path.stem} {channel}" for channel in "RGB"]
    light, lines = _row(np.linspace(0, 1, SAMPLES)), []
    for name, channel in zip(names, lut.channels, strict=True):
        lines += [name, "graph", "I =", light, "B =", _row(brightness_samples(channel))]
    atomic_write_text(path, "\n".join([*lines, ""]), overwrite=overwrite, error=LutError)
    return ()


def _row(values: Float64Array) -> str:
    """Return numbers with seven digits, as DoRF has them."""
    return " ".join(f"{value:.7g}" for value in values.tolist())


def _curves(source: LutText) -> list[DorfCurve]:
    """Return all curves of the text."""
    lines = [(number, text.strip()) for number, text in enumerate(source.lines, 1) if text.strip()]
    heads = [index for index, (_, text) in enumerate(lines) if _HEADING.fullmatch(text)]
    if len(heads) < 2 or len(heads) % 2 or heads[0] < 2:
        raise source.error("holds no curve of DoRF: a name, the kind of graph, 'I =', a row, 'B =' and a row")
    starts = [*heads[::2], len(lines) + 2]
    curves = []
    for start, middle, end in zip(starts, heads[1::2], starts[1:], strict=False):
        line, name = lines[start - 2]
        rows = {
            lines[head][1][0].replace("E", "I"): _numbers(source, lines[head + 1 : stop])
            for head, stop in ((start, middle), (middle, end - 2))
        }
        if set(rows) != {"I", "B"} or rows["I"].size != rows["B"].size or rows["I"].size < 2:
            raise source.error(f"the curve {name!r} needs as many irradiances as brightnesses, two or more", line=line)
        curves.append(DorfCurve(name, line, rows["I"], rows["B"]))
    return curves


def _numbers(source: LutText, rows: Sequence[tuple[int, str]]) -> Float64Array:
    """Return the numbers of some lines."""
    return np.array([number for line, text in rows for number in source.numbers(text, line, count=len(text.split()))])


def _chosen(source: LutText, curves: Sequence[DorfCurve], name: str) -> DorfCurve:
    """Return the curve of a name or a number from 1, or the only one."""
    if not name and len(curves) == 1:
        return curves[0]
    named = {curve.name: curve for curve in reversed(curves)}
    numbered = {str(number): curve for number, curve in enumerate(curves, 1)}
    if found := named.get(name) or numbered.get(name):
        return found
    listed = ", ".join(curve.name for curve in curves[:5]) + (", …" if len(curves) > 5 else "")
    problem = f"has no curve {name!r}" if name else f"holds {len(curves)} curves"
    raise source.error(f"{problem} ({listed}); name one: crfnet convert {source.path.name} one.spi1d --curve NAME")
