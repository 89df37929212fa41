"""Signals that end a run: Control-C, and what a render farm or a closed terminal sends."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

#: The signals, as far as the system has them.
_NAMES = ("SIGINT", "SIGTERM", "SIGHUP")


class Interruption:
    """Which signal has ended the run; `signal` is None as long as none has."""

    def __init__(self) -> None:
        self.signal: int | None = None

    def __call__(self, number: int, _: FrameType | None) -> None:
        """Raise a KeyboardInterrupt at the first signal; further ones must not disturb the cleaning up."""
        if self.signal is None:
            self.signal = number
            raise KeyboardInterrupt

    @property
    def exit_code(self) -> int:
        """The exit code of a process that a signal ended: 130 for Control-C."""
        return 128 + (self.signal or signal.SIGINT)


@contextmanager
def interruptible() -> Iterator[Interruption]:
    """Turn the first signal during a block into a KeyboardInterrupt, and yield a record of it.

    A signal that is ignored, as under nohup, or that the caller handles stays as it is. Outside the main thread, where
    Python handles no signals, nothing changes.
    """
    interruption = Interruption()
    ordinary = (signal.SIG_DFL, signal.default_int_handler)
    earlier = {}
    if threading.current_thread() is threading.main_thread():
        numbers = [getattr(signal, name) for name in _NAMES if hasattr(signal, name)]
        earlier = {number: signal.getsignal(number) for number in numbers if signal.getsignal(number) in ordinary}
    for number in earlier:
        signal.signal(number, interruption)
    try:
        yield interruption
    finally:
        for number, handler in earlier.items():
            signal.signal(number, handler)
