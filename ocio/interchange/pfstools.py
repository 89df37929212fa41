"""The response files of pfstools: `pfshdrcalibrate --save-response` and `--response-file`, suffix .m.

A matrix in GNU Octave's text format for each of the channels IR, IG and IB, with a row for each code: log10(response),
code, response. The response at a code is the light that makes it, so it is an inverse one; -6 and 0 stand for codes
that were not measured. A last matrix W holds the weight of each code when pictures are merged.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from crfnet_core.files import atomic_write_text
from crfnet_core.types import Float64Array

from ..errors import LutError
from ..luts.rgb_lut import AnyLut
from ..luts.text import LutText
from .calibration import CODES, calibrated_response, codes_table
from .response_file import ResponseFile

CHANNELS = ("IR", "IG", "IB")

_MATRIX = re.compile(r"# name: (\w+)\n# type: matrix\n# rows: (\d+)\n# columns: 3\n([^#]*)")


def read_pfstools(path: Path) -> ResponseFile:
    """Return the response in a .m file of pfshdrcalibrate.

    Raises
    ------
    LutError
        If it is absent, cut, of another kind, or does not increase.
    """
    source = LutText.read(path)
    found = {match[1]: match for match in _MATRIX.finditer("\n".join(source.lines) + "\n")}
    if not set(CHANNELS) <= found.keys():
        raise source.error("holds no matrices IR, IG and IB; give a file of pfshdrcalibrate --save-response")
    columns = [_light(source, int(found[name][2]), found[name][3]) for name in CHANNELS]
    if len({len(column) for column in columns}) > 1:
        raise source.error("the channels differ in their number of codes; the file is cut or altered")
    return calibrated_response(path, np.stack(columns, axis=1), "pfstools response")


def write_pfstools(path: Path, lut: AnyLut, *, overwrite: bool = False) -> tuple[str, ...]:
    """Write an inverse response for `pfshdrcalibrate --response-file`, over codes of 8 bits.

    The weights are a Gaussian about the middle code, as wide as pfshdrcalibrate's own.

    Raises
    ------
    LutError
        If the file exists and may not be replaced, or cannot be written.
    """
    lines = []
    for name, column in zip(CHANNELS, codes_table(lut).T, strict=True):
        lines += [
            f"# Camera response curve, channel {name}",
            "# data layout: log10(response) | camera output | response",
        ]
        lines += [f"# name: {name}", "# type: matrix", f"# rows: {CODES}", "# columns: 3"]
        lines += [f" {np.log10(light):.6e} {code:4d} {light:.6e}" for code, light in enumerate(column.tolist())]
        lines.append("")
    lines += ["# Weighting function", "# data layout: weight | camera output", "# name: W", "# type: matrix"]
    weights = np.exp(-((np.linspace(0, 1, CODES) - 0.5) ** 2) / (2 * 0.2**2))
    lines += [
        f"# rows: {CODES}",
        "# columns: 2",
        *(f" {weight:.6e} {code:4d}" for code, weight in enumerate(weights)),
        "",
    ]
    atomic_write_text(path, "\n".join([*lines, ""]), overwrite=overwrite, error=LutError)
    return ()


def _light(source: LutText, rows: int, text: str) -> Float64Array:
    """Return the third column of a matrix, in the order of the codes."""
    table = [source.numbers(line, None, count=3) for line in text.splitlines() if line.strip()]
    if len(table) != rows or [int(row[1]) for row in table] != list(range(rows)):
        raise source.error(f"holds {len(table)} codes and announces {rows}; the file is cut or altered")
    return np.array(table)[:, 2]
