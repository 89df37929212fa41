"""`crfnet convert`: a response from one file format to another."""

from __future__ import annotations

import argparse
from pathlib import Path

from ...errors import LutError
from ...interchange.files import read_response, write_response
from ...luts.files import WRITERS, write_lut
from ...luts.forward import forward_lut
from ...luts.rgb_lut import AnyLut
from .printing import print_json, print_lines


def run(arguments: argparse.Namespace) -> None:
    """Read a response, write it in another format, and say what was read and how exact the file is."""
    found = read_response(arguments.source, curve=arguments.curve)
    notes = [f"{arguments.source.name}: {found.words}", *found.notes]
    notes += _write(arguments.out, found.lut, is_forward=arguments.forward, overwrite=arguments.overwrite)
    if arguments.json:
        print_json({"source": str(arguments.source), "written": str(arguments.out), "notes": notes})
    else:
        print_lines([*(f"{note}." for note in notes), f"Written: {arguments.out}."])


def _write(out: Path, lut: AnyLut, *, is_forward: bool, overwrite: bool) -> tuple[str, ...]:
    """Write the file and return what is to be said of it."""
    if not is_forward:
        return write_response(out, lut, overwrite=overwrite)
    if out.suffix.lower() not in WRITERS:
        raise LutError(f"{out}: --forward is for LUTs; give a name that ends in {', '.join(WRITERS)}")
    table = forward_lut(lut)
    write_lut(out, table, overwrite=overwrite)
    return table.comments[:2]
