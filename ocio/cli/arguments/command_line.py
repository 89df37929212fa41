"""The whole command line of `crfnet`."""

from __future__ import annotations

import argparse
import sys

from . import calibrate, camera, completion, config, estimate, info, linearize
from .parts import Parser


class _Version(argparse.Action):
    """Print the version, which takes half as long to look up as everything else takes to start."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import version

        sys.stdout.write(f"{parser.prog} {version('crfnet')}\n")
        parser.exit()


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of the whole command line."""
    parser = Parser(
        prog="crfnet",
        description="Camera response from one photograph: LUTs, an OpenColorIO config and a linear plate.",
        epilog="crfnet COMMAND --help shows examples.",
    )
    parser.add_argument(
        "--version", action=_Version, nargs=0, default=argparse.SUPPRESS, help="show program's version number and exit"
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for subcommand in (estimate, calibrate, camera, linearize, config, info, completion):
        subcommand.add(commands)
    return parser
