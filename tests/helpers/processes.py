"""Run a process to its end, or start one that Control-C can interrupt, however the tests themselves were started."""

import signal
import subprocess


def start_interruptible(command, **options):
    """Start `command` with the default handlers of the signals that end a run; POSIX only.

    A process inherits ignored signals from the one that started it: a shell ignores SIGINT in the jobs that it runs in
    the background, and nohup ignores SIGHUP, as in ``nohup make test &``. The command then leaves them ignored, and a
    test that sends one would wait for ever.
    """
    return subprocess.Popen(command, preexec_fn=_restore_signals, **options)


def ran(*command, **options):
    """Return how a command ended, with the texts that it printed."""
    return subprocess.run(command, capture_output=True, text=True, check=False, **options)


def _restore_signals():
    """Let the signals do in this process what they do by default."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
        signal.signal(number, signal.SIG_DFL)
