"""`crfnet completion`: a script by which a shell completes the command line."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator

import shtab

from ..arguments.command_line import build_parser

#: What the arguments that name files and folders are called in the help.
FILES = {"CONFIG", "FILE", "FILE|MODEL", "FRAME", "LOOK", "OUT", "PATTERN", "PHOTO", "PLATES", "SOURCE"}
FOLDERS = {"DIR", "MODEL"}


def run(arguments: argparse.Namespace) -> None:
    """Print the script."""
    parser = build_parser()
    for argument in all_arguments(parser):
        if argument.metavar in FOLDERS:
            argument.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
        elif argument.metavar in FILES or "FILE" in str(argument.metavar).split("|"):
            argument.complete = shtab.FILE  # type: ignore[attr-defined]
    sys.stdout.write(shtab.complete(parser, shell=arguments.shell) + "\n")


def all_arguments(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """Return the arguments of a parser and of its subcommands."""
    for argument in parser._actions:
        yield argument
        if isinstance(argument, argparse._SubParsersAction):
            for subcommand in argument.choices.values():
                yield from all_arguments(subcommand)
