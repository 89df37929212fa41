"""The streams of the command: complete, able to show every name, and stderr for its own lines alone."""

import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def complete_streams() -> None:
    """Give a process whose output is closed somewhere to print to, and escape what an output cannot show.

    With PYTHONUNBUFFERED, Python takes no notice of output that a full disk cuts short, so that stdout gets a buffer.
    """
    if isinstance(getattr(sys.stdout, "buffer", None), io.RawIOBase):
        whole = io.BufferedWriter(io.FileIO(sys.stdout.fileno(), "w", closefd=False))
        sys.stdout = io.TextIOWrapper(whole, sys.stdout.encoding)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name) or Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115 - it stays
        setattr(sys, name, stream)
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


@contextmanager
def own_stderr() -> Iterator[None]:
    """Let nothing but this program print on stderr during a block.

    Libraries in C print there by themselves what an error says already, as libpng does for a damaged file. They print
    to the process's file, which leads nowhere meanwhile; `sys.stderr` has a copy of its own.
    """
    process_stderr = sys.stderr
    if process_stderr is not sys.__stderr__ or not isinstance(process_stderr, io.TextIOWrapper):
        yield
        return
    number = process_stderr.fileno()
    copy = io.FileIO(os.dup(number), "w")  # without a buffer, which could fail once more when it is closed
    sys.stderr = io.TextIOWrapper(copy, process_stderr.encoding, process_stderr.errors, write_through=True)
    try:
        with Path(os.devnull).open("wb") as nowhere:
            os.dup2(nowhere.fileno(), number)
        yield
    finally:
        os.dup2(copy.fileno(), number)
        sys.stderr = process_stderr
        copy.close()


def shown(text: str) -> str:
    """Return a line as the command prints it: control characters, as names of files hold them, are question marks."""
    return "".join(  # surrogates, of names that are not Unicode, stay: the streams escape them
        character if character.isprintable() or "\ud800" <= character <= "\udfff" else "?" for character in text
    )
