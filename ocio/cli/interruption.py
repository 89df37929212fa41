"""Signals that end a run: Control-C, and what a render farm, a closed terminal or a limit of time sends."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

#: The signals, as far as the system has them.
_NAMES = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGXCPU", "SIGUSR1", "SIGUSR2")


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
        numbers = [getattr(signal, name) for name in _NAMES if hasattr(signal, name)]
        earlier = {number: signal.getsignal(number) for number in numbers if signal.getsignal(number) in ordinary}
    for number in earlier:
        signal.signal(number, interrupt)
    try:
        yield caught
    finally:
        for number, handler in earlier.items():
            signal.signal(number, handler)
