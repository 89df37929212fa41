"""A Blender with its window, on a screen of its own, and what may be asked of it."""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

from tests.blender_window.screen import Screen

#: What runs inside Blender.
INSIDE = Path(__file__).parent / "inside" / "serve.py"

#: How many of the last letters that Blender printed an error quotes.
LAST = 2000

#: Seconds that Blender may take to start, and to answer.
START, ANSWER = 300, 600


class Blender:
    """A running Blender, whose window fills a screen; use it in a `with` statement, or call `quit`.

    Everything that it stores is in the folder ``blender`` of `home`.
    """

    def __init__(self, program: str, screen: Screen, home: Path) -> None:
        self.screen, self.home, self.user = screen, home, home / "blender"
        self._folder = Path(tempfile.mkdtemp(prefix="crf_blender_"))
        self._socket, self._log, self._printed = self._folder / "socket", self._folder / "log", ""
        command = [program, "--window-geometry", "0", "0", str(screen.width), str(screen.height)]
        command += ["--python", str(INSIDE), "--", str(self._socket)]
        with self._log.open("wb") as log:
            self._process = subprocess.Popen(command, env=self._environment(), stdout=log, stderr=log)
        try:
            self._wait()
        except BaseException:
            self._process.kill()
            self.quit()
            raise

    def __enter__(self) -> Blender:
        return self

    def __exit__(self, *_raised: object) -> None:
        self.quit()

    def call(self, function: str, *arguments: Any, **options: Any) -> Any:
        """Return what a function of a module in `inside`, such as ``editors.box`` returns."""
        return self._ask({"function": function, "arguments": arguments, "options": options})

    def value(self, expression: str) -> Any:
        """Return what a Python expression is worth inside Blender: numbers, texts, lists and dictionaries of them."""
        return self._ask({"expression": expression})

    @property
    def printed(self) -> str:
        """What Blender has printed so far, its errors among it."""
        return self._log.read_text(encoding="utf-8", errors="replace") if self._log.exists() else self._printed

    def quit(self) -> None:
        """End Blender as its user does, by the operator; kill it if it does not end."""
        if self._process.poll() is None:
            try:
                self._ask({"expression": "bpy.app.timers.register(lambda: runs.quit())"})
                self._process.wait(START)
            except (OSError, RuntimeError, subprocess.TimeoutExpired):
                self._process.kill()
                self._process.wait()
        if self._folder.exists():
            self._printed = self.printed
            shutil.rmtree(self._folder)

    def _environment(self) -> dict[str, str]:
        """Return the environment of a user who has set nothing."""
        dropped = ("OCIO", "BLENDER_OCIO", "WAYLAND_DISPLAY", "PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV")
        kept = {name: text for name, text in os.environ.items() if name not in dropped and not name.startswith("XDG_")}
        runtime = self._folder / "runtime"
        runtime.mkdir(mode=0o700)
        self.user.mkdir(parents=True, exist_ok=True)
        return kept | {
            "DISPLAY": self.screen.display,
            "HOME": str(self.home),
            "XDG_RUNTIME_DIR": str(runtime),
            "BLENDER_USER_RESOURCES": str(self.user),
            "LIBGL_ALWAYS_SOFTWARE": "1",
            "LANG": "C.UTF-8",
        }

    def _wait(self) -> None:
        """Wait until Blender answers."""
        deadline = time.monotonic() + START
        while time.monotonic() < deadline:
            if self._process.poll() is not None:
                raise RuntimeError(f"Blender ended: {self.printed[-LAST:]}")
            try:
                self.value("1")
                return
            except (FileNotFoundError, ConnectionRefusedError):
                time.sleep(0.1)
        raise RuntimeError(f"Blender did not start in {START} s: {self.printed[-LAST:]}")

    def _ask(self, question: dict[str, Any]) -> Any:
        """Return the answer to a question; RuntimeError with Blender's traceback if it failed."""
        with socket.socket(socket.AF_UNIX) as connection:
            connection.settimeout(ANSWER)
            connection.connect(str(self._socket))
            with connection.makefile("rw", encoding="utf-8") as stream:
                print(json.dumps(question), file=stream, flush=True)
                line = stream.readline()
        if not line:
            code = self._process.poll()
            raise RuntimeError(f"Blender ended with {code}: {self.printed[-LAST:]}")
        found = json.loads(line)
        if "error" in found:
            raise RuntimeError(found["error"])
        return found["value"]
