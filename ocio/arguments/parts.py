"""Options that several subcommands of `crfnet` have, and the types of their values."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import NoReturn, TypeAlias

import shtab

from ocio.defaults import DEPTHS, MAX_EXPOSURE, PRIORS

#: Exit code of refused arguments and refused files.
BAD_INPUT = 2


class Parser(argparse.ArgumentParser):
    """An argument parser whose error messages are one line."""

    def error(self, message: str) -> NoReturn:
        """Print `message` on one line and exit with `BAD_INPUT`."""
        self.exit(BAD_INPUT, f"crfnet: error: {message} (see {self.prog} --help)\n")


Commands: TypeAlias = "argparse._SubParsersAction[Parser]"


def add_command(commands: Commands, name: str, summary: str, examples: str) -> argparse.ArgumentParser:
    """Add a subcommand with examples at the end of its help."""
    return commands.add_parser(
        name,
        help=summary,
        description=summary[0].upper() + summary[1:] + ".",
        epilog=examples,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )


def add_network(parser: argparse.ArgumentParser) -> None:
    """Add the options of commands that run the network."""
    model = parser.add_argument("--model", type=Path, metavar="MODEL", help="another model: a folder, or crfnet2017")
    model.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
    prior = parser.add_argument(
        "--prior",
        default=PRIORS[0],
        metavar="|".join((*PRIORS, "FILE")),
        help=f"what to expect: today's cameras, any source (film, old video too), or as a JSON file says ({PRIORS[0]})",
    )
    prior.complete = shtab.FILE  # type: ignore[attr-defined]
    parser.add_argument(
        "--ignore-metadata",
        action="store_true",
        help="leave out what the files say of their camera and of programs that changed them",
    )
    parser.add_argument(
        "--threads", type=count, default=0, metavar="N", help="threads of the network (0: as many as cores)"
    )


def add_plate(parser: argparse.ArgumentParser) -> None:
    """Add the options of commands that write linear plates."""
    parser.add_argument("--depth", choices=DEPTHS, default=DEPTHS[0], help=f"of the linear EXR ({DEPTHS[0]})")
    parser.add_argument("--exposure", type=stops, default=0.0, metavar="STOPS", help="gain of the linear EXR (0)")
    parser.add_argument("--overwrite", action="store_true", help="replace files that are already there")
    add_json(parser)


def add_json(parser: argparse.ArgumentParser) -> None:
    """Add --json."""
    parser.add_argument("--json", action="store_true", help="print one JSON document instead of words")


def positive(text: str) -> int:
    """Return the integer in `text`, which must be 1 or more."""
    if (number := int(text)) < 1:
        raise argparse.ArgumentTypeError(f"{text} is below 1")
    return number


def count(text: str) -> int:
    """Return the integer in `text`, which must be 0 or more."""
    if (number := int(text)) < 0:
        raise argparse.ArgumentTypeError(f"{text} is below 0")
    return number


def stops(text: str) -> float:
    """Return the exposure in `text`, which must be within `MAX_EXPOSURE` stops."""
    if not abs(value := float(text)) <= MAX_EXPOSURE:
        raise argparse.ArgumentTypeError(f"{text} is not between -{MAX_EXPOSURE} and {MAX_EXPOSURE} stops")
    return value
