"""`crfnet completion`: a script by which a shell completes the command line."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import shtab

from ..arguments.command_line import build_parser
from ..arguments.parts import written_path

#: The words in the help for files and folders that the parser does not make paths of.
PATHS = {"CONFIG", "PLATES", "camera|any|FILE"}


def run(arguments: argparse.Namespace) -> None:
    """Print the script."""
    parser = build_parser()
    for argument in _arguments(parser):
        if argument.type in (Path, written_path) or argument.metavar in PATHS:
            argument.complete = shtab.FILE  # type: ignore[attr-defined]
    sys.stdout.write(shtab.complete(parser, shell=arguments.shell) + "\n")


def _arguments(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """Yield the arguments of a parser and of its subcommands."""
    for argument in parser._actions:
        yield argument
        if isinstance(argument, argparse._SubParsersAction):
            for subcommand in argument.choices.values():
                yield from _arguments(subcommand)
