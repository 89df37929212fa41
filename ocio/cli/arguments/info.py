"""`crfnet info`: its arguments."""

from __future__ import annotations

from pathlib import Path

from .parts import Commands, add_command, add_json

EXAMPLES = """examples:
  crfnet info look/plate01.spi1d
  crfnet info models/mine"""


def add(commands: Commands) -> None:
    """Add `crfnet info`."""
    parser = add_command(commands, "info", "say what a LUT file or a model folder holds", EXAMPLES)
    parser.add_argument(
        "subject", type=Path, metavar="FILE|MODEL", help="a LUT that OpenColorIO reads, or a model folder"
    )
    add_json(parser)
