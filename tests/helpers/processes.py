"""Start a process that Control-C can interrupt, however the tests themselves were started."""

from __future__ import annotations

import signal
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any


def start_interruptible(command: Sequence[str | Path], **options: Any) -> subprocess.Popen[Any]:
    """Start `command` with the default handler of SIGINT; POSIX only.

    A process inherits an ignored SIGINT from the one that started it, and a shell ignores SIGINT in the jobs that it
    runs in the background, as in ``nohup make test &``. Python then installs no handler of its own, and a test that
    sends SIGINT would wait for ever.

    Parameters
    ----------
    command : sequence of str or Path
        The program and its arguments.
    **options
        Passed to `subprocess.Popen`.
    """
    return subprocess.Popen(command, preexec_fn=_restore_interrupt, **options)


def _restore_interrupt() -> None:
    """Let SIGINT do in this process what it does by default."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
