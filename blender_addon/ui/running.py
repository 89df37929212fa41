# SPDX-License-Identifier: GPL-3.0-or-later
"""The one run that is under way: a job in another thread, and how its progress is shown.

Every display makes Blender draw parts of its window, which takes processor time from the job, so there are few.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import bpy

from ..scene.plates import EDITORS
from ..work.background import BackgroundTask

#: Seconds between two checks of whether the job has ended.
TICK = 0.05

#: Seconds between two displays of the progress: without a graphics card, one takes a third of a second.
REDRAW = 2.0

#: The run that is under way, or None.
current: Run | None = None


class Run:
    """A job in another thread, with its timer and the display of its progress.

    `name` is the plate's, `function` the job, see `BackgroundTask`, and `doing` a verb that stands before the name.
    """

    def __init__(self, context: bpy.types.Context, name: str, function: Callable[..., Any], doing: str) -> None:
        self.name, self._doing = name, doing
        self.task: BackgroundTask[Any] = BackgroundTask(function)
        self._manager, self._workspace = context.window_manager, context.workspace
        self._timer = self._manager.event_timer_add(TICK, window=context.window)
        self._manager.progress_begin(0, 100)
        self._shown, self._shown_at = "", 0.0

    @property
    def text(self) -> str:
        """How far the job is, in words; without a number until there is one, as 0 % would look stuck."""
        if self.task.cancelled.is_set():
            return "Canceling"
        percent = self.task.percent
        return f"{self.name}: {percent} %" if percent else f"{self._doing} {self.name} ..."

    def cancel(self) -> None:
        """Ask the job to stop, and show that it was asked."""
        self.task.cancelled.set()
        self._shown_at = 0.0
        self.show()

    def show(self) -> None:
        """Show the progress in the status bar, at the mouse pointer and in the panel, unless it was shown just now."""
        text = self.text if self.task.cancelled.is_set() else f"Camera response: {self.text}  |  Esc to cancel"
        if text == self._shown or time.monotonic() - self._shown_at < REDRAW:
            return
        self._shown, self._shown_at = text, time.monotonic()
        set_status(self._workspace, text)
        self._manager.progress_update(self.task.percent)
        redraw_editors(self._manager, regions=("UI",))

    def end(self) -> None:
        """Remove the timer and the display, once; then no run is current."""
        global current
        if current is not self:
            return
        current = None
        self._manager.event_timer_remove(self._timer)
        self._manager.progress_end()
        set_status(self._workspace, None)
        redraw_editors(self._manager)


def why_busy() -> str:
    """Return that a run is under way, for the tooltip of an operator that has to wait; empty if there is none."""
    if current is None:
        return ""
    return f"The camera response of {current.name} is running: wait for its end, or cancel it"


def start(context: bpy.types.Context, name: str, function: Callable[..., Any], *, doing: str = "Estimating") -> Run:
    """Return a run that has just been started; there must be no other."""
    global current
    current = Run(context, name, function, doing)
    current.show()
    current.task.start()
    return current


def stop() -> None:
    """Cancel the run that is under way, if any, and remove its display without waiting for its end."""
    if current is not None:
        current.task.cancelled.set()
        current.end()


def set_status(workspace: bpy.types.WorkSpace, text: str | None) -> None:
    """Set the text of the status bar in a workspace, which may have been removed meanwhile."""
    with suppress(ReferenceError), bpy.context.temp_override(workspace=workspace):  # else it is set in the present one
        workspace.status_text_set(text)


def redraw_editors(manager: bpy.types.WindowManager, *, regions: tuple[str, ...] = ()) -> None:
    """Have the editors that show the panel drawn again in all windows, or only some types of their regions."""
    for window in manager.windows:
        for area in window.screen.areas:
            for region in area.regions if area.type in EDITORS else ():
                if not regions or region.type in regions:
                    region.tag_redraw()
