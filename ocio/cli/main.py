"""The `crfnet` command: exit codes, error lines and signals; `crfnet.cli.arguments` parses, the commands work."""

import argparse
import os
import signal
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path

from ..messages import NOT_TEXT
from .arguments.command_line import build_parser
from .arguments.parts import BAD_INPUT
from .streams import complete_streams, own_stderr, shown

#: The signals that end a run, as far as the system has them: Control-C, and what a render farm, a closed terminal or a
#: limit of time sends.
SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGXCPU", "SIGUSR1", "SIGUSR2")

#: Errors whose own message would not help the user.
UNEXPLAINED: dict[type[BaseException], str] = {
    MemoryError: "not enough memory; close something or give fewer photographs",
    UnicodeEncodeError: f"a file's name {NOT_TEXT}",
    RuntimeError: "the system starts no more threads; close something, or raise its limit of processes",
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command; return 0, `BAD_INPUT`, `NOT_TRUSTED` (with --strict), or 128 and the signal that ended it."""
    complete_streams()
    with own_stderr(), interruptible() as caught:
        try:
            return _run(build_parser().parse_args(argv), sys.argv if argv is None else argv)
        except OSError as problem:  # of --help
            return _fail(problem)
        except ImportError as problem:  # without the core, which may be what cannot be loaded
            reason = " ".join(str(problem).split())
            _print_error(f"crfnet: error: {reason}; clear PYTHONPATH, install crfnet again, or give it more memory")
            return BAD_INPUT
        except BaseException as problem:  # an interrupted import raises all sorts of errors
            if not caught and not isinstance(problem, KeyboardInterrupt):
                raise
            _print_error("crfnet: interrupted")
            return 128 + next(iter(caught), signal.SIGINT)


@contextmanager
def interruptible() -> Iterator[list[int]]:
    """Turn the first signal during a block into a KeyboardInterrupt, and yield a list that then holds its number.

    Further ones must not disturb the cleaning up. A signal that is ignored, as under nohup, or that the caller handles
    stays as it is. Outside the main thread, where Python handles no signals, nothing changes.
    """
    caught: list[int] = []

    def interrupt(number: int, _: object) -> None:
        if not caught:
            caught.append(number)
            raise KeyboardInterrupt

    ordinary = (signal.SIG_DFL, signal.default_int_handler)
    earlier = {}
    if threading.current_thread() is threading.main_thread():
        numbers = [getattr(signal, name) for name in SIGNALS if hasattr(signal, name)]
        earlier = {number: signal.getsignal(number) for number in numbers if signal.getsignal(number) in ordinary}
    for number in earlier:
        signal.signal(number, interrupt)
    try:
        yield caught
    finally:
        for number, handler in earlier.items():
            signal.signal(number, handler)


def _run(arguments: argparse.Namespace, argv: Sequence[str]) -> int:
    """Run the module of the subcommand's name in `crfnet.cli.commands` and return the exit code."""
    # Imported only now, because the core imports numpy and onnxruntime, for which --help must not wait.
    from crfnet_core.errors import CRFNetError
    from crfnet_core.files import escaped_name

    from .remedies import CommandError

    try:
        given = vars(arguments)
        alone = set(map(Path, given.get("photos", given.get("plates", ())))) if given.get("each") else set()
        for text in argv:
            if Path(text) not in alone and (name := escaped_name(text)) != text:
                raise CommandError("name_not_unicode", name=name)
        code = import_module(f"crfnet.cli.commands.{arguments.command}").run(arguments)
        sys.stdout.flush()
    except (CRFNetError, OSError, MemoryError, UnicodeError, RuntimeError) as problem:
        if isinstance(problem, RuntimeError) and "new thread" not in str(problem):
            raise  # of a bug
        return _fail(problem)
    return code or 0


def _fail(problem: BaseException) -> int:
    """Print the problem on one line and return the exit code."""
    try:
        sys.stdout.flush()
    except OSError:  # Python flushes it once more at its end
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    if isinstance(problem, BrokenPipeError):  # as in `crfnet info X | head`: nobody reads the output any more
        return BAD_INPUT
    from crfnet_core.errors import CRFNetError, one_line  # as above

    from .remedies import explained

    unexplained = (text for kind, text in UNEXPLAINED.items() if isinstance(problem, kind))
    text = explained(problem) if isinstance(problem, CRFNetError) else next(unexplained, str(problem))
    if isinstance(problem, OSError) and problem.strerror:
        text = f"{problem.filename or 'the output'}: {problem.strerror}; check the name, the folder and the disk"
    _print_error(f"crfnet: error: {one_line(text)}")
    return BAD_INPUT


def _print_error(line: str) -> None:
    """Print a line on stderr, if stderr takes it."""
    with suppress(OSError):
        print(shown(line), file=sys.stderr, flush=True)  # noqa: T201


if __name__ == "__main__":
    sys.exit(main())
