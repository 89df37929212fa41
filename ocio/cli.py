"""The `crfnet` command: arguments, exit codes and error lines. The subcommands are in `ocio.commands`."""

from __future__ import annotations

import argparse
import io
import os
import sys
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import NoReturn, TypeAlias

import shtab

from ocio.defaults import DEPTHS, LUT_LENGTH, MAX_EXPOSURE, PRIORS, WINDOWS

#: Exit codes.
BAD_INPUT = 2
INTERRUPTED = 130

ESTIMATE_EXAMPLES = """examples:
  crfnet estimate plate01.jpg --out look
  crfnet estimate day1/*.jpg --out look            several photographs of one camera, one response
  crfnet estimate cam_a.jpg cam_b.jpg --each --out look        one response each
  crfnet estimate scan.tif --out look --prior any              film scans, old video: not only today's cameras

For plate01.jpg the folder then holds plate01.spi1d, .cube and .clf (the inverse response as a LUT), config.ocio,
plate01_linear.exr, plate01_sheet.png (what was found, as a picture) and plate01.json."""

LINEARIZE_EXAMPLES = """examples:
  crfnet linearize plate01.jpg --lut look/plate01.spi1d --out plate01_linear.exr
  crfnet linearize shot.%04d.png --lut look/plate01.spi1d --out linear/shot.%04d.exr
  crfnet linearize 'shot.####.jpg' --frames 1001-1100 --out 'linear/shot.####.exr'

Without --lut one response is estimated from several of the frames. Frames that are already written are left alone,
so an interrupted run goes on where it stopped."""

INFO_EXAMPLES = """examples:
  crfnet info look/plate01.spi1d
  crfnet info models/mine"""

COMPLETION_EXAMPLES = """examples:
  crfnet completion bash > ~/.local/share/bash-completion/completions/crfnet
  crfnet completion zsh > ~/.zfunc/_crfnet"""

#: Errors whose own message would not help the user.
UNEXPLAINED: dict[type[BaseException], str] = {
    MemoryError: "not enough memory; close something or give fewer photographs",
    UnicodeEncodeError: "a file's name is no valid Unicode; rename it",
}


class Parser(argparse.ArgumentParser):
    """An argument parser whose error messages are one line."""

    def error(self, message: str) -> NoReturn:
        """Print `message` on one line and exit with `BAD_INPUT`."""
        self.exit(BAD_INPUT, f"crfnet: error: {message} (see {self.prog} --help)\n")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code: 0, `BAD_INPUT` or `INTERRUPTED`."""
    _print_any_character()
    arguments = build_parser().parse_args(argv)
    # Imported only now, because the core imports numpy and onnxruntime, for which --help must not wait.
    from crfnet_core.errors import CRFNetError

    try:
        "".join(sys.argv if argv is None else argv).encode()  # refuses file names that are not valid Unicode
        _run(arguments)
        sys.stdout.flush()
    except (CRFNetError, OSError, MemoryError, UnicodeError) as problem:
        return _fail(problem)
    except KeyboardInterrupt:
        print("crfnet: interrupted", file=sys.stderr)  # noqa: T201
        return INTERRUPTED
    return 0


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of the whole command line."""
    parser = Parser(
        prog="crfnet",
        description="Camera response from one photograph: LUTs, an OpenColorIO config and a linear plate.",
        epilog="crfnet COMMAND --help shows examples.",
    )
    parser.add_argument("--version", action="version", version=f"crfnet {version('crfnet')}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    _add_estimate(commands)
    _add_linearize(commands)
    _add_info(commands)
    _add_completion(commands)
    return parser


Commands: TypeAlias = "argparse._SubParsersAction[Parser]"


def _add_estimate(commands: Commands) -> None:
    """Add `crfnet estimate`."""
    parser = _command(
        commands, "estimate", "estimate the response of the camera that took a photograph", ESTIMATE_EXAMPLES
    )
    photos = parser.add_argument("photos", nargs="+", type=Path, metavar="PHOTO", help="JPEG, PNG, TIFF, WebP or DPX")
    photos.complete = shtab.FILE  # type: ignore[attr-defined]
    out = parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for everything written")
    out.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
    parser.add_argument("--each", action="store_true", help="one response per photograph, not one for all")
    parser.add_argument(
        "--windows", type=_positive, default=WINDOWS, metavar="N", help=f"windows per photograph ({WINDOWS})"
    )
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="which windows are drawn (0)")
    parser.add_argument(
        "--length", type=_positive, default=LUT_LENGTH, metavar="N", help=f"entries of the LUTs ({LUT_LENGTH})"
    )
    parser.add_argument("--no-sheet", action="store_true", help="do not draw the picture")
    _add_network(parser)
    _add_plate(parser)


def _add_linearize(commands: Commands) -> None:
    """Add `crfnet linearize`."""
    parser = _command(commands, "linearize", "write a plate or a frame sequence as linear EXR", LINEARIZE_EXAMPLES)
    plates = parser.add_argument(
        "plates", metavar="PLATES", help="a file, or a sequence: shot.%%04d.png, shot.####.png"
    )
    plates.complete = shtab.FILE  # type: ignore[attr-defined]
    out = parser.add_argument("--out", required=True, metavar="PATTERN", help="file, or pattern like that of PLATES")
    out.complete = shtab.FILE  # type: ignore[attr-defined]
    lut = parser.add_argument("--lut", type=Path, metavar="FILE", help="the inverse response: .spi1d, .cube or .clf")
    lut.complete = shtab.FILE  # type: ignore[attr-defined]
    parser.add_argument("--frames", metavar="SPEC", help="which frames, like 1001-1100 or 1-99x2 (all)")
    _add_network(parser)
    _add_plate(parser)


def _add_info(commands: Commands) -> None:
    """Add `crfnet info`."""
    parser = _command(commands, "info", "say what a LUT file or a model folder holds", INFO_EXAMPLES)
    subject = parser.add_argument(
        "subject", type=Path, metavar="FILE|MODEL", help=".spi1d, .cube, .clf, or a model folder"
    )
    subject.complete = shtab.FILE  # type: ignore[attr-defined]
    _add_json(parser)


def _add_completion(commands: Commands) -> None:
    """Add `crfnet completion`."""
    parser = _command(commands, "completion", "print the shell completion script", COMPLETION_EXAMPLES)
    parser.add_argument("shell", choices=shtab.SUPPORTED_SHELLS)


def _command(commands: Commands, name: str, summary: str, examples: str) -> argparse.ArgumentParser:
    """Add a subcommand with examples at the end of its help."""
    return commands.add_parser(
        name,
        help=summary,
        description=summary[0].upper() + summary[1:] + ".",
        epilog=examples,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )


def _add_network(parser: argparse.ArgumentParser) -> None:
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
        "--threads", type=_count, default=0, metavar="N", help="threads of the network (0: as many as cores)"
    )


def _add_plate(parser: argparse.ArgumentParser) -> None:
    """Add the options of commands that write linear plates."""
    parser.add_argument("--depth", choices=DEPTHS, default=DEPTHS[0], help=f"of the linear EXR ({DEPTHS[0]})")
    parser.add_argument("--exposure", type=_stops, default=0.0, metavar="STOPS", help="gain of the linear EXR (0)")
    parser.add_argument("--overwrite", action="store_true", help="replace files that are already there")
    _add_json(parser)


def _add_json(parser: argparse.ArgumentParser) -> None:
    """Add --json."""
    parser.add_argument("--json", action="store_true", help="print one JSON document instead of words")


def _positive(text: str) -> int:
    """Return the integer in `text`, which must be 1 or more."""
    if (number := int(text)) < 1:
        raise argparse.ArgumentTypeError(f"{text} is below 1")
    return number


def _count(text: str) -> int:
    """Return the integer in `text`, which must be 0 or more."""
    if (number := int(text)) < 0:
        raise argparse.ArgumentTypeError(f"{text} is below 0")
    return number


def _stops(text: str) -> float:
    """Return the exposure in `text`, which must be within `MAX_EXPOSURE` stops."""
    if not abs(stops := float(text)) <= MAX_EXPOSURE:
        raise argparse.ArgumentTypeError(f"{text} is not between -{MAX_EXPOSURE} and {MAX_EXPOSURE} stops")
    return stops


def _run(arguments: argparse.Namespace) -> None:
    """Run the subcommand."""
    if arguments.command == "completion":
        sys.stdout.write(shtab.complete(build_parser(), shell=arguments.shell) + "\n")
        return
    from ocio import commands

    run = {"estimate": commands.run_estimate, "linearize": commands.run_linearize, "info": commands.run_info}
    run[arguments.command](arguments)


def _print_any_character() -> None:
    """Print characters that the terminal or the pipe cannot show as escapes, instead of failing."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _fail(problem: BaseException) -> int:
    """Print the problem on one line and return the exit code."""
    if isinstance(problem, BrokenPipeError):  # as in `crfnet info X | head`: nobody reads the output any more
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BAD_INPUT
    text = UNEXPLAINED.get(type(problem), str(problem))
    print(f"crfnet: error: {' '.join(text.split())}", file=sys.stderr)  # noqa: T201
    return BAD_INPUT


if __name__ == "__main__":
    sys.exit(main())
