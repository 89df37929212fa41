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


class BackgroundTask(threading.Thread, Generic[Returned]):
    """One call of a function in a thread of its own, which must not touch Blender's data.

    The function gets a progress callback, which it calls with (done, total); once `cancelled` is set, that ends it.
    """

    def __init__(self, function: Callable[[Progress], Returned]) -> None:
        super().__init__(name="camera response", daemon=True)
        self._function = function
        self._future: Future[Returned] = Future()
        self.cancelled = threading.Event()
        self.done, self.total = 0, 0

    @property
    def percent(self) -> int:
        """The progress reported last, from 0 to 100."""
        return 100 * self.done // max(1, self.total)

    def result(self) -> Returned:
        """Return the result of the function, or raise its exception; the thread must have ended."""
        return self._future.result()

    def run(self) -> None:
        """Call the function and keep its result or its exception for the other thread."""
        try:
            self._future.set_result(self._function(self._progress))
        except BaseException as raised:  # noqa: BLE001 - `result` raises it again
            self._future.set_exception(raised)

    def _progress(self, done: int, total: int) -> None:
        """Keep the progress, and stop the function if it was canceled."""
        self.done, self.total = done, total
        if self.cancelled.is_set():
            raise CancelledError("Canceled; nothing was changed")
