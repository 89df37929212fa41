"""Options that several subcommands of `crfnet` have, and the types of their values."""

import argparse
from pathlib import Path
from typing import NamedTuple, NoReturn, TypeAlias

from ...defaults import DEPTHS, DEVICES, GRAY_BRIGHTNESS, MAX_EXPOSURE, OUTPUT_SPACES, PRIMARIES, PRIORS
from ..streams import shown

#: Exit code of refused arguments and refused files.
BAD_INPUT = 2

#: Exit code with --strict if a response is not to be trusted; everything is written nevertheless.
NOT_TRUSTED = 3


class Exposure(NamedTuple):
    """The exposure asked for: stops after the anchor, which is white or an encoded brightness of 18 % gray."""

    stops: float = 0.0
    gray: float | None = None


class Parser(argparse.ArgumentParser):
    """An argument parser whose error messages are one line."""

    def error(self, message: str) -> NoReturn:
        """Print `message` on one line and exit with `BAD_INPUT`."""
        self.exit(BAD_INPUT, f"crfnet: error: {shown(message)} (see {self.prog} --help)\n")


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


def add_action(actions: Commands, name: str, summary: str) -> argparse.ArgumentParser:
    """Add one action of a subcommand, with --json."""
    parser = actions.add_parser(name, help=summary, description=summary[0].upper() + summary[1:] + ".")
    add_json(parser)
    return parser


def add_network(parser: argparse.ArgumentParser) -> None:
    """Add the options of commands that run the network."""
    parser.add_argument("--model", type=Path, metavar="MODEL", help="another model: a folder, or crfnet2017")
    parser.add_argument(
        "--prior",
        default=PRIORS[0],
        metavar="|".join((*PRIORS, "FILE")),
        help=f"what to expect: today's cameras, any source (film, old video too), or as a JSON file says ({PRIORS[0]})",
    )
    parser.add_argument("--camera", metavar="NAME", help="the response of a stored camera: see crfnet camera list")
    parser.add_argument(
        "--taken-with",
        choices=DEVICES,
        help="what took the photograph, if you know and its file does not say: a phone, a compact camera, a camera with"
        " interchangeable lenses, or any other, such as a drone or one that you do not know",
    )
    parser.add_argument(
        "--ignore-metadata",
        action="store_true",
        help="leave out what the files say of their camera and of programs that changed them",
    )
    parser.add_argument(
        "--strict", action="store_true", help=f"end with exit code {NOT_TRUSTED} if a response is not to be trusted"
    )


def add_plate(parser: argparse.ArgumentParser) -> None:
    """Add the options of commands that write linear plates."""
    parser.add_argument("--depth", choices=DEPTHS, default=DEPTHS[0], help=f"of the linear EXR ({DEPTHS[0]})")
    parser.add_argument(
        "--exposure",
        type=exposure,
        default=Exposure(),
        metavar="STOPS|white|gray|gray=B",
        help="gain of the linear EXR: stops; white at 1 (the default); 18 %% gray at 0.18, by its code 118 of"
        " 255 or as picked, like gray=0.42",
    )
    parser.add_argument(
        "--primaries",
        choices=PRIMARIES,
        default=PRIMARIES[0],
        help=f"of the plate; auto: as it is tagged ({PRIMARIES[0]})",
    )
    parser.add_argument(
        "--output-space",
        choices=OUTPUT_SPACES,
        default=OUTPUT_SPACES[0],
        help="of the linear EXR: scene_linear of our config, that is Rec.709; the plate's own primaries; or ACES"
        f" ({OUTPUT_SPACES[0]})",
    )
    parser.add_argument("--overwrite", action="store_true", help="replace files that are already there")
    add_json(parser)


def add_frames(parser: argparse.ArgumentParser, each: str) -> None:
    """Add --frames, and --each, which a text explains, with its workers."""
    parser.add_argument("--frames", metavar="SPEC", help="which frames, like 1001-1100 or 1-99x2 (all)")
    parser.add_argument("--each", action="store_true", help=each)
    parser.add_argument(
        "--workers", type=positive, metavar="N", help="with --each: photographs at a time (as many as cores)"
    )
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", help="with --each: a Dask scheduler, such as tcp://10.0.0.1:8786"
    )


def add_json(parser: argparse.ArgumentParser) -> None:
    """Add --json."""
    parser.add_argument("--json", action="store_true", help="print one JSON document instead of words")


def positive(text: str) -> int:
    """Return the integer in `text`, which must be 1 or more."""
    if (number := int(text)) < 1:
        raise argparse.ArgumentTypeError(f"{text} is below 1")
    return number


def written_path(text: str) -> Path:
    """Return the path in `text`, which must not be empty, as an unset variable of a shell is."""
    if not text:
        raise argparse.ArgumentTypeError("is empty; give a name, or . for the current folder")
    return Path(text)


def exposure(text: str) -> Exposure:
    """Return the exposure in `text`: white, gray, gray=BRIGHTNESS, in any case, or stops within `MAX_EXPOSURE`."""
    anchor, _, brightness = text.lower().replace("grey", "gray").partition("=")
    if text.lower() == "white":
        return Exposure()
    if anchor == "gray":
        return Exposure(gray=_brightness(brightness) if "=" in text else GRAY_BRIGHTNESS)
    if not abs(value := float(text)) <= MAX_EXPOSURE:
        raise argparse.ArgumentTypeError(f"{text} is not between -{MAX_EXPOSURE} and {MAX_EXPOSURE} stops")
    return Exposure(stops=value)


def _brightness(text: str) -> float:
    """Return the encoded brightness in `text`, which must be above 0 and at most 1."""
    if not 0 < (value := float(text)) <= 1:
        raise argparse.ArgumentTypeError(f"a gray of {text} is not between 0 and 1; divide a code by 255")
    return value
