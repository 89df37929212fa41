# SPDX-License-Identifier: GPL-3.0-or-later
"""A function in a thread of its own, with progress and cancellation; knows neither Blender nor the estimator."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import TYPE_CHECKING, Generic, TypeVar

from .errors import CancelledError

if TYPE_CHECKING:
    from crfnet_core.types import Progress

Returned = TypeVar("Returned")


class BackgroundTask(Generic[Returned]):
    """One call of a function in a thread of its own, which must not touch Blender's data.

    The function gets a progress callback, which it calls with (done, total); canceling takes effect there.
    """

    def __init__(self, function: Callable[[Progress], Returned]) -> None:
        self._function = function
        self._future: Future[Returned] = Future()
        self._cancelled = threading.Event()
        self._thread = threading.Thread(target=self._run, name="camera response", daemon=True)
        self.done, self.total = 0, 0

    @property
    def is_running(self) -> bool:
        """Whether the function has been started and has not ended yet."""
        return self._thread.is_alive()

    @property
    def is_cancelled(self) -> bool:
        """Whether `cancel` was called."""
        return self._cancelled.is_set()

    @property
    def percent(self) -> int:
        """The progress reported last, from 0 to 100."""
        return 100 * self.done // max(1, self.total)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def cancel(self) -> None:
        """Ask the function to stop; it does so when it next reports its progress."""
        self._cancelled.set()

    def wait(self, timeout: float | None = None) -> None:
        """Wait until the thread has ended, for at most `timeout` seconds."""
        self._thread.join(timeout)

    def result(self) -> Returned:
        """Return the result of the function, or raise its exception; the thread must have ended."""
        return self._future.result()

    def _progress(self, done: int, total: int) -> None:
        """Keep the progress, and stop the function if it was canceled."""
        self.done, self.total = done, total
        if self.is_cancelled:
            raise CancelledError("Canceled; nothing was changed")

    def _run(self) -> None:
        """Call the function and keep its result or its exception for the other thread."""
        try:
            self._future.set_result(self._function(self._progress))
        except BaseException as raised:  # noqa: BLE001 - `result` raises it again
            self._future.set_exception(raised)
