"""The `crfnet` command: exit codes and error lines; `ocio.arguments` parses, `ocio.commands` works."""

from __future__ import annotations

import argparse
import io
import os
import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.metadata import version

import shtab

from ocio.arguments import completion, estimate, info, linearize
from ocio.arguments.parts import BAD_INPUT, Parser

#: Exit code after Ctrl-C.
INTERRUPTED = 130

#: Errors whose own message would not help the user.
UNEXPLAINED: dict[type[BaseException], str] = {
    MemoryError: "not enough memory; close something or give fewer photographs",
    UnicodeEncodeError: "a file's name is no valid Unicode; rename it",
}


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
    for subcommand in (estimate, linearize, info, completion):
        subcommand.add(commands)
    return parser


def _run(arguments: argparse.Namespace) -> None:
    """Run the subcommand: the module of its name in `ocio.commands`."""
    if arguments.command == "completion":
        sys.stdout.write(shtab.complete(build_parser(), shell=arguments.shell) + "\n")
        return
    import_module(f"ocio.commands.{arguments.command}").run(arguments)


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
