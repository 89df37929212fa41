"""A screen without a monitor: Xvfb, the mouse and the keyboard of xdotool, and pictures of what is shown.

The pictures are read from the memory of Xvfb, so no program that takes pictures is needed.
"""

from __future__ import annotations

import os
import shutil
import struct
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

#: The programs that a screen needs.
PROGRAMS = ("Xvfb", "xdotool")

#: Seconds that Xvfb may take to start.
START = 20

#: Seconds between the movements of the mouse and its clicks, so that Blender sees one after the other.
PAUSE = 0.05


@dataclass(frozen=True)
class Box:
    """A rectangle of the screen in pixels, (x, y) its upper left corner."""

    x: int
    y: int
    width: int
    height: int


@dataclass(frozen=True)
class Picture:
    """Pixels of the screen."""

    width: int
    height: int
    rgb: bytes  # one byte each, the top row first

    def cropped(self, box: Box) -> Picture:
        """Return the pixels inside a box, which must lie inside the picture."""
        rows = range(box.y, box.y + box.height)
        starts = [3 * (row * self.width + box.x) for row in rows]
        return Picture(box.width, box.height, b"".join(self.rgb[at : at + 3 * box.width] for at in starts))

    def trimmed(self) -> Picture:
        """Return the picture without the equal rows at its lower end, all but one of them."""
        rows = [self.rgb[at : at + 3 * self.width] for at in range(0, len(self.rgb), 3 * self.width)]
        while len(rows) > 1 and rows[-1] == rows[-2]:
            rows.pop()
        return Picture(self.width, len(rows), b"".join(rows))

    def difference(self, other: Picture) -> float:
        """Return the fraction of pixels that differ from a picture of the same size."""
        if self.rgb == other.rgb:
            return 0.0
        pixels = range(0, len(self.rgb), 3)
        return sum(self.rgb[at : at + 3] != other.rgb[at : at + 3] for at in pixels) / len(pixels)


class Screen:
    """A running Xvfb of a size in pixels, until `close`."""

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        self._memory = Path(tempfile.mkdtemp(prefix="crf_screen_"))
        reading, writing = os.pipe()
        command = ["Xvfb", "-displayfd", str(writing), "-screen", "0", f"{width}x{height}x24"]
        command += ["-fbdir", str(self._memory), "-nolisten", "tcp", "-nocursor"]
        log = (self._memory / "log").open("wb")
        with log:
            self._process = subprocess.Popen(command, pass_fds=[writing], stdout=log, stderr=log)
        os.close(writing)
        with os.fdopen(reading) as numbers:
            self.display = f":{numbers.readline().strip()}"
        if self.display == ":":
            message = (self._memory / "log").read_text(errors="replace")
            self.close()
            raise RuntimeError(f"Xvfb does not start: {message}")

    def close(self) -> None:
        """End Xvfb."""
        self._process.terminate()
        self._process.wait(START)
        shutil.rmtree(self._memory, ignore_errors=True)

    def move(self, x: int, y: int) -> None:
        """Move the mouse to a pixel."""
        self._xdotool("mousemove", x, y)

    def click(self, x: int, y: int) -> None:
        """Click with the left button on a pixel."""
        self.move(x - 1, y)
        self.move(x, y)
        time.sleep(2 * PAUSE)
        self._xdotool("click", 1)

    def key(self, name: str) -> None:
        """Press a key, such as ``Escape`` or ``ctrl+z``."""
        self._xdotool("key", name)
        time.sleep(PAUSE)

    def picture(self, box: Box | None = None) -> Picture:
        """Return what is shown now, or the part of it in a box."""
        memory = (self._memory / "Xvfb_screen0").read_bytes()  # in the format of xwd
        header = struct.unpack(">25I", memory[:100])
        size, width, height, bits, row, colors = (header[index] for index in (0, 4, 5, 11, 12, 19))
        if bits != 32 or row != 4 * width:
            raise RuntimeError(f"Xvfb keeps {bits} bits a pixel and {row} bytes a row; 32 and {4 * width} are read")
        start = size + 12 * colors
        stored = memory[start : start + row * height]
        rgb = bytearray(3 * width * height)
        rgb[0::3], rgb[1::3], rgb[2::3] = stored[2::4], stored[1::4], stored[0::4]
        whole = Picture(width, height, bytes(rgb))
        return whole.cropped(box) if box else whole

    def _xdotool(self, *arguments: object) -> None:
        """Run xdotool on this screen."""
        environment = {**os.environ, "DISPLAY": self.display}
        subprocess.run(["xdotool", *map(str, arguments)], env=environment, check=True, timeout=START)
        time.sleep(PAUSE)
