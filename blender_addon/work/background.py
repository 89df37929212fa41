# SPDX-License-Identifier: GPL-3.0-or-later
"""Work in another thread, watched from Blender's: knows neither Blender nor the estimator."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from .errors import CancelledError

Progress = Callable[[int, int], None]


class Task:
    """One call of `work(progress)` in another thread.

    `work` must not touch Blender's data. It is cancelled at its next call of `progress`.

    Parameters
    ----------
    work : callable
        Takes a progress callback (done, total) and returns what `result` hands on.
    """

    def __init__(self, work: Callable[[Progress], Any]) -> None:
        self._work = work
        self._result: Any = None
        self._problem: BaseException | None = None
        self._is_cancelled = threading.Event()
        self._thread = threading.Thread(target=self._run, name="camera response", daemon=True)
        self.done, self.total = 0, 0

    @property
    def is_running(self) -> bool:
        """Whether the thread is still at work."""
        return self._thread.is_alive()

    @property
    def is_cancelled(self) -> bool:
        """Whether it was asked to stop."""
        return self._is_cancelled.is_set()

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def cancel(self) -> None:
        """Ask the thread to stop; it does so at its next step."""
        self._is_cancelled.set()

    def wait(self, timeout: float | None = None) -> None:
        """Wait until the thread has ended, at most `timeout` seconds."""
        self._thread.join(timeout)

    def result(self) -> Any:
        """Return what the work returned, or raise what it raised; the thread must have ended.

        Raises
        ------
        CancelledError
            If it was cancelled.
        """
        if self._problem is not None:
            raise self._problem
        return self._result

    def progress(self, done: int, total: int) -> None:
        """Take note of how far the work is, in its thread; raises CancelledError there once it is cancelled."""
        self.done, self.total = done, total
        if self.is_cancelled:
            raise CancelledError("Cancelled; nothing was changed")

    def _run(self) -> None:
        """Work, and keep the outcome, whatever it is, for the other thread."""
        try:
            self._result = self._work(self.progress)
        except BaseException as problem:  # noqa: BLE001 - raised again by `result`
            self._problem = problem
