# SPDX-License-Identifier: GPL-3.0-or-later
"""Let another Blender decode movies to PNG files of their code values.

It is the decoder that shows the plate in this Blender, so the code values are the same. It runs in a process of its
own, without a window and without the user's settings, so the open file is not touched and the window does not freeze.
"""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from crfnet.plates.frames import FrameSequence
from crfnet_core.types import Progress, show_progress

from .errors import AddonError
from .job import CONFIG_VARIABLES, BlenderDecoder, Plate

#: Seconds between two looks for a decoded frame.
_TICK = 0.05


class FrameDecoder:
    """A running Blender that decodes the frames of one movie; see `running_decoder`."""

    def __init__(self, plate: Plate, process: subprocess.Popen[str], folder: Path) -> None:
        self._plate, self._process, self._folder = plate, process, folder

    def read(self, sequence: FrameSequence, progress: Progress | None = None) -> FrameSequence:
        """Return frames as PNG files, which the next call removes.

        Parameters
        ----------
        sequence : FrameSequence
            The frames to decode by their numbers; the names of the new files are those of `sequence.paths`.
        progress : callable or None
            Called with (done, total) while a frame is awaited, too; what it raises ends the wait.

        Raises
        ------
        AddonError
            If Blender cannot decode a frame.
        """
        for path in self._folder.glob("*.png"):
            path.unlink()
        decoded = []
        for done, (path, number) in enumerate(zip(sequence.paths, sequence.numbers, strict=True)):
            target = self._folder / f"{path.stem}.png"
            self._ask(number, target)
            while not target.exists():
                show_progress(progress, done, len(sequence.paths))
                self._check(number, target)
            decoded.append(target)
        return FrameSequence(tuple(decoded), sequence.numbers, sequence.missing)

    def _ask(self, number: int, target: Path) -> None:
        """Ask for one frame; a Blender that has ended is noticed by `_check`."""
        request = {"file": str(self._plate.file), "frame": number, "target": str(target)}
        assert self._process.stdin is not None
        with suppress(OSError):
            self._process.stdin.write(json.dumps(request) + "\n")
            self._process.stdin.flush()

    def _check(self, number: int, target: Path) -> None:
        """Wait a moment, and raise an AddonError if Blender has ended without the frame."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(_TICK)
        if self._process.poll() is not None and not target.exists():
            name = f"{self._plate.file.name}, frame {number}"
            raise AddonError(f"{name}: Blender cannot decode it ({self._reason()}); save it as JPEG, PNG or TIFF")

    def _reason(self) -> str:
        """Return the last line that Blender wrote to its error output."""
        lines = (self._folder / "errors.txt").read_text(encoding="utf-8", errors="replace").strip().splitlines()
        return lines[-1] if lines else "it gives no reason"


@contextmanager
def running_decoder(plate: Plate, decoder: BlenderDecoder, folder: Path) -> Iterator[FrameDecoder]:
    """Start another Blender, yield what decodes frames with it, and end it.

    Parameters
    ----------
    plate : Plate
        A movie.
    decoder : BlenderDecoder
        The command that starts Blender.
    folder : Path
        An empty folder for the decoded frames, which the caller removes.

    Raises
    ------
    AddonError
        If Blender cannot be started.
    """
    environment = {name: value for name, value in os.environ.items() if name not in CONFIG_VARIABLES}
    environment["BLENDER_USER_RESOURCES"] = str(folder / "user")  # not there: Blender's own config, no add-ons
    arguments = [*decoder.command, *(["--deinterlace"] if decoder.is_deinterlaced else [])]
    with (folder / "errors.txt").open("w", encoding="utf-8") as errors:
        try:
            process = subprocess.Popen(
                arguments,
                env=environment,
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=errors,
                text=True,
                encoding="utf-8",
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            )
        except OSError as problem:
            raise AddonError(
                f"{plate.name}: no second Blender can be started to decode it ({problem.strerror}); save the frames as"
                " JPEG, PNG or TIFF"
            ) from None
        try:
            yield FrameDecoder(plate, process, folder)
        finally:
            process.kill()
            process.wait()
            with suppress(OSError):
                process.stdin.close()  # type: ignore[union-attr]
