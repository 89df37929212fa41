"""An artist at a Blender: opens plates, finds a button under the mouse and presses it, waits until a run has ended."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.blender_window.screen import Box, Picture
from tests.blender_window.session import LAST, Blender

#: The buttons of the panel, as Blender writes their Python commands.
ESTIMATE, APPLY = "bpy.ops.crf.estimate_response(", "bpy.ops.crf.apply_response("
SHOW_PLATE, SHOW_LINEAR = "bpy.ops.crf.compare(is_after=False", "bpy.ops.crf.compare(is_after=True"
CANCEL = "bpy.ops.crf.cancel_run("

#: How Blender prints the report of an operator.
REPORT = "operator         | "

#: The name of the image that the Image Editor shows, as an expression in Blender.
SHOWN = "[area for area in editors.window().screen.areas if area.type == 'IMAGE_EDITOR'][0].spaces.active.image.name"

#: Height of a button in pixels at a scale of 1, at least; the mouse looks for buttons in half of it.
BUTTON = 16

#: Where in the width of the sidebar buttons are looked for.
COLUMNS = (0.5, 0.3, 0.75, 0.83)

#: Seconds that a run and everything else may take.
RUN, MOMENT = 300, 60


class Artist:
    """Works in the Image Editor of a running Blender; `keep` stores the picture when waiting was in vain."""

    def __init__(self, blender: Blender, *, scale: float, theme: str, keep: Callable[[Picture, str], Any]) -> None:
        self.blender, self.call, self.value = blender, blender.call, blender.value
        self.screen, self._scale, self._keep = blender.screen, scale, keep
        self.call("editors.look", scale=scale, theme=theme)

    def open(self, path: Path, *, alone: bool = True) -> str:
        """Open an image in the Image Editor, the panel beside it; return its name."""
        if not self.value("[area for area in editors.window().screen.areas if area.type == 'IMAGE_EDITOR'] and 1"):
            self.call("editors.show", "IMAGE_EDITOR", alone=alone)
            self.settle()
        name = self.call("plates.open_image", str(path))
        self.settle()
        self.call("editors.show_tab", "IMAGE_EDITOR")
        self.settle()
        return name

    def settle(self) -> None:
        """Move the mouse over the picture, so that Blender draws, and wait until it has drawn."""
        x, y = self.screen.width // 3, self.screen.height // 2
        for step in (0, 4, 8):
            self.screen.move(x + step, y)
        before = None
        for _ in range(20):
            time.sleep(0.25)
            for _ in range(2):  # it answers between its events and draws after them, so the second answer comes later
                self.value("1")
            shown = self.screen.picture().rgb
            if shown == before:
                return
            before = shown

    def sidebar(self, editor: str = "IMAGE_EDITOR") -> Box:
        """Return where the sidebar of an editor is."""
        return Box(*self.call("editors.box", editor, "UI"))

    def status_bar(self) -> Box:
        """Return where the status bar has hints and messages: not its border, nor its right end with the version."""
        height, border = round(18 * self._scale), round(2 * self._scale)
        top = self.screen.height - height + border
        return Box(border, top, self.screen.width * 3 // 4, height - border)

    def picture(self, box: Box | None = None) -> Picture:
        """Return what is shown now."""
        return self.screen.picture(box)

    def find(self, command: str, *, row: int | None = None) -> tuple[int, int]:
        """Return the middle of the button of a command in the sidebar, or near a row of it if one is given.

        Raises
        ------
        LookupError
            If there is none.
        """
        if row is None:
            self.settle()  # Blender forgets the button that was pressed last
        box, step = self.sidebar(), round(BUTTON * self._scale / 2)
        first, last = (box.y + step, box.y + box.height) if row is None else (row - 2 * step, row + 2 * step)
        for column in COLUMNS:
            x = box.x + round(column * box.width)
            rows = []
            for y in range(first, last, step):
                if self._is_lit(command, x, y):
                    rows.append(y)
                elif rows:
                    break
            if rows:
                return x, (rows[0] + rows[-1]) // 2
        raise LookupError(f"there is no button {command}...) in the sidebar")

    def press(self, command: str = ESTIMATE, position: tuple[int, int] | None = None) -> None:
        """Press a button of the sidebar, which is found unless its position is given.

        Blender ignores a click on a button that is not lit yet, as when it reads the movement and the click at once.
        """
        place = position or self.find(command)
        self.wait(lambda: self._is_lit(command, *place), f"the button {command}...) is lit")
        self.screen.click(*place)

    def start(self, command: str = ESTIMATE) -> None:
        """Press a button that starts a run, and wait until it runs or has reported."""
        position, reports = self.find(command), self._reports()
        self.call("runs.watch")
        self.press(command, position)
        self.wait(lambda: self.call("runs.has_started") or self._reports() > reports, "the run starts", MOMENT)

    def run(self, command: str = ESTIMATE) -> None:
        """Press a button that starts a run, and wait until it has ended."""
        self.start(command)
        self.wait_for_end()

    def apply(self) -> None:
        """Press Estimate, and Apply when it has ended: the two clicks from a photograph to its light."""
        self.run()
        self.run(APPLY)

    def wait_for_end(self) -> None:
        """Wait until the run has ended, unless it was too short to be seen."""
        if self.call("runs.has_started"):
            self.wait(lambda: self.call("runs.has_ended"), "the run ends", RUN)

    def _is_lit(self, command: str, x: int, y: int) -> bool:
        """Move the mouse to a pixel, and return whether Blender has lit the button of a command there."""
        self.screen.move(x - 1, y)  # Blender leaves a button at one movement, and enters the next at another
        self.screen.move(x, y)
        return self.call("editors.button", "IMAGE_EDITOR", "UI").startswith(command)

    def _reports(self) -> int:
        """Return how often Blender has printed the report of an operator."""
        return self.blender.printed.count(REPORT)

    def wait(self, condition: Callable[[], Any], what: str, seconds: float = MOMENT) -> None:
        """Wait until a condition holds; TimeoutError if it takes longer."""
        deadline = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > deadline:
                kept = self._keep(self.picture(), f"waited_in_vain_{time.time_ns()}")
                raise TimeoutError(
                    f"waited {seconds} s: {what} (see {kept}); Blender says: {self.blender.printed[-LAST:]}"
                )
            time.sleep(0.05)
