"""Start a process that Control-C can interrupt, however the tests themselves were started."""

from __future__ import annotations

import signal
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any


def start_interruptible(command: Sequence[str | Path], **options: Any) -> subprocess.Popen[Any]:
    """Start `command` with the default handlers of the signals that end a run; POSIX only.

    A process inherits ignored signals from the one that started it: a shell ignores SIGINT in the jobs that it runs in
    the background, and nohup ignores SIGHUP, as in ``nohup make test &``. The command then leaves them ignored, and a
    test that sends one would wait for ever.

    Parameters
    ----------
    command : sequence of str or Path
        The program and its arguments.
    **options
        Passed to `subprocess.Popen`.
    """
    return subprocess.Popen(command, preexec_fn=_restore_signals, **options)


def _restore_signals() -> None:
    """Let the signals do in this process what they do by default."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
