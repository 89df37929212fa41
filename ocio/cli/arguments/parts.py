"""Options that several subcommands of `crfnet` have, and the types of their values."""

import argparse
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple, NoReturn, TypeAlias

from ...defaults import DEPTHS, DEVICES, GRAY_BRIGHTNESS, MAX_EXPOSURE, OUTPUT_SPACES, PRIMARIES, PRIORS
from ..streams import shown

#: Exit code of refused arguments and refused files.
BAD_INPUT = 2

#: Exit code with --strict if a response is not to be trusted; everything is written nevertheless.
NOT_TRUSTED = 3

OVERWRITE = "replace files that are already there"


class Exposure(NamedTuple):
    """The exposure asked for: stops after the anchor, which is white or an encoded brightness of 18 % gray."""

    stops: float = 0.0
    gray: float | None = None


class Parser(argparse.ArgumentParser):
    """An argument parser whose error messages are one line, and whose help raises OSError if nothing takes it."""

    def print_help(self, file: Any = None) -> None:
        """Print the help; argparse ignores errors of the output."""
        print(self.format_help(), end="", file=file, flush=True)

    def error(self, message: str) -> NoReturn:
        """Print `message` on one line and exit with `BAD_INPUT`."""
        self.exit(BAD_INPUT, f"crfnet: error: {shown(message)} (see {self.prog} --help)\n")


Commands: TypeAlias = "argparse._SubParsersAction[Parser]"
Kind: TypeAlias = Callable[[str], Any]


def given(text: str) -> str:
    """Return a text, which must not be empty, as an unset variable of a shell is."""
    if not text:
        raise argparse.ArgumentTypeError("is empty; give a value (the current folder is .)")
    return text


def given_path(text: str) -> Path:
    """Return the path in a text, which must not be empty: that would be the current folder."""
    return Path(given(text))


def add_command(commands: Commands, name: str, summary: str, examples: str) -> Parser:
    """Add a subcommand with examples at the end of its help."""
    return commands.add_parser(
        name,
        help=summary,
        description=summary[0].upper() + summary[1:] + ".",
        epilog=examples,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )


def add_action(actions: Commands, name: str, summary: str) -> Parser:
    """Add one action of a subcommand, with --json."""
    parser = actions.add_parser(name, help=summary, description=summary[0].upper() + summary[1:] + ".")
    add_json(parser)
    return parser


def add_flag(parser: Parser, name: str, meaning: str) -> None:
    """Add an option without a value."""
    parser.add_argument(name, action="store_true", help=meaning)


def add_value(parser: Parser, name: str, metavar: str, meaning: str, kind: Kind = given, **more: Any) -> None:
    """Add an option or an argument with a value, any text by default."""
    parser.add_argument(name, type=kind, metavar=metavar, help=meaning, **more)


def add_out(parser: Parser, metavar: str, meaning: str) -> None:
    """Add --out."""
    add_value(parser, "--out", metavar, meaning, given_path, required=True)


def add_json(parser: Parser) -> None:
    """Add --json."""
    add_flag(parser, "--json", "print one JSON document instead of text")


def add_choice(parser: Parser, name: str, choices: Sequence[str], meaning: str) -> None:
    """Add an option with one of several values; the first is the default."""
    parser.add_argument(name, choices=choices, default=choices[0], help=f"{meaning} (default: {choices[0]})")


def add_network(parser: Parser) -> None:
    """Add the options of commands that run the network."""
    add_value(parser, "--model", "MODEL", "crfnet2017, the method of the paper; or the folder of a model", given_path)
    prior = "responses to expect: today's cameras, any source (with film and old video), or shares in a JSON file"
    add_value(parser, "--prior", "|".join((*PRIORS, "FILE")), f"{prior} (default: {PRIORS[0]})", default=PRIORS[0])
    add_value(parser, "--camera", "NAME", "use the response of a stored camera; crfnet camera list shows them")
    parser.add_argument(
        "--taken-with",
        choices=DEVICES,
        help="kind of camera, if the file does not name it: a phone, a compact camera, a camera with interchangeable"
        " lenses, or another or unknown one, such as a drone",
    )
    add_flag(parser, "--ignore-metadata", "ignore the camera, the programs and the encoding that the files name")
    add_flag(parser, "--strict", f"exit code {NOT_TRUSTED} if a response is not to be trusted")


def add_plate(parser: Parser) -> None:
    """Add the options of commands that write linear plates."""
    add_choice(parser, "--depth", DEPTHS, "samples of the EXR files")
    gain = "gain of the linear light: a number of stops; white puts code 255 at 1 (default); gray puts code 118, and"
    gain += " gray=0.42 a brightness of 0.42, at 0.18"
    add_value(parser, "--exposure", "STOPS|white|gray|gray=B", gain, exposure, default=Exposure())
    add_choice(parser, "--primaries", PRIMARIES, "primaries of the plate; auto: by its tags")
    space = "primaries of the linear EXR: scene_linear is Rec.709, as in the config that is written; plate: the plate's"
    add_choice(parser, "--output-space", OUTPUT_SPACES, space)
    add_flag(parser, "--overwrite", OVERWRITE)
    add_json(parser)


def add_frames(parser: Parser, each: str) -> None:
    """Add --frames, and --each, which a text explains, with its workers."""
    parser._negative_number_matcher = re.compile(r"-\.?\d")  # not the whole word: --frames -3--1
    add_value(parser, "--frames", "SPEC", "frames, such as 1001-1100 or 1-99x2 (default: all)")
    add_flag(parser, "--each", each)
    add_value(parser, "--workers", "N", "with --each: processes at a time (default: one per core)", positive)
    add_value(parser, "--scheduler", "ADDRESS", "with --each: Dask scheduler, such as tcp://10.0.0.1:8786")


def positive(text: str) -> int:
    """Return the integer in `text`, which must be 1 or more."""
    if (number := int(text)) < 1:
        raise argparse.ArgumentTypeError(f"{text} is below 1")
    return number


def exposure(text: str) -> Exposure:
    """Return the exposure in `text`: white, gray, gray=BRIGHTNESS (above 0, at most 1), in any case, or stops."""
    anchor, _, brightness = text.lower().replace("grey", "gray").partition("=")
    if text.lower() == "white":
        return Exposure()
    if anchor == "gray":
        gray = float(brightness) if "=" in text else GRAY_BRIGHTNESS
        if not 0 < gray <= 1:
            raise argparse.ArgumentTypeError(f"a gray of {brightness} is not between 0 and 1; divide a code by 255")
        return Exposure(gray=gray)
    if not abs(value := float(text)) <= MAX_EXPOSURE:
        raise argparse.ArgumentTypeError(f"{text} is not between -{MAX_EXPOSURE} and {MAX_EXPOSURE} stops")
    return Exposure(stops=value)
