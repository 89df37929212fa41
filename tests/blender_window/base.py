"""The base of all cases: a user's home in which the add-on is installed, plates to work on, a place for pictures."""

from __future__ import annotations

import atexit
import functools
import json
import os
import shutil
import tempfile
import unittest
from pathlib import Path
from typing import Any

from tests.blender_window.artist import Artist
from tests.blender_window.png import write_png
from tests.blender_window.screen import Picture, Screen
from tests.blender_window.session import LAST, Blender

#: Where `make test-blender-window` says what to use.
BLENDER, ZIP, FILES, PICTURES = (f"CRFNET_WINDOW_{name}" for name in ("BLENDER", "ZIP", "FILES", "PICTURES"))

#: Why the cases are skipped elsewhere.
SKIPPED = "needs a Blender with a window: make test-blender-window BLENDER=blender"

#: Size of the screen at a scale of 1 and of 2.
SIZES = {1: (1920, 1080), 2: (2560, 2000)}

#: The largest differences of linear values, white = 1, of an 8-bit plate.
NODES, BAKED = 2e-6, 1e-7


class WindowTest(unittest.TestCase):
    """A case with a home of its own, in which the add-on is installed and enabled, and a folder for its plates."""

    is_installed = True

    @classmethod
    def setUpClass(cls) -> None:
        if BLENDER not in os.environ:
            raise unittest.SkipTest(SKIPPED)

    def setUp(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="crf_window_"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.home = self.folder / "home"
        self.blenders: list[Blender] = []
        if self.is_installed:
            copy_home(installed_home(), self.home)

    def tearDown(self) -> None:
        """Assert that no Blender has printed a traceback: what fails while a panel is drawn appears nowhere else."""
        for blender in self.blenders:
            blender.quit()
            assert "Traceback" not in blender.printed, blender.printed[-LAST:]

    def start(self, *, scale: int = 1, theme: str = "dark") -> Artist:
        """Return an artist at a Blender that has just started."""
        blender = Blender(os.environ[BLENDER], screen(*SIZES[scale]), self.home)
        self.blenders.append(blender)
        self.addCleanup(blender.quit)
        return Artist(blender, scale=scale, theme=theme, keep=self.keep)

    def plate(self, name: str) -> Path:
        """Return a copy of a plate in the case's own folder."""
        target = self.folder / "project" / name
        target.parent.mkdir(parents=True, exist_ok=True)
        return Path(shutil.copyfile(files() / "plates" / name, target))

    def assert_linear(self, artist: Artist, path: str | Path, plate: str, most: float, *, beside: str = "") -> None:
        """Assert that an EXR file holds, beside an object, the linear values that `crfnet estimate` wrote."""
        difference = self.difference(artist, path, plate, beside=beside)
        self.assertLessEqual(difference, most, f"largest difference from the linear values of {plate}")

    def difference(self, artist: Artist, path: str | Path, plate: str, **options: str) -> float:
        """Return the largest difference of an EXR file from the linear values that `crfnet estimate` wrote."""
        expected = files() / "expected" / Path(plate).with_suffix("") / f"{Path(plate).stem}_linear.exr"
        return artist.call("plates.largest_difference", str(path), str(expected), **options)

    def assert_view(self, artist: Artist, view: list[float]) -> None:
        """Assert that zoom and position are as they were, to a pixel of the screen."""
        for found, expected in zip(artist.call("editors.view"), view, strict=True):
            self.assertAlmostEqual(found, expected, delta=1)

    def keep(self, picture: Picture, name: str) -> Path:
        """Keep a picture for whoever looks at it later."""
        folder = Path(os.environ[PICTURES])
        folder.mkdir(parents=True, exist_ok=True)
        return write_png(folder / f"{name}.png", picture)


def files() -> Path:
    """Return the folder of `make_files`."""
    return Path(os.environ[FILES]).resolve()


def package() -> Path:
    """Return the extension's zip."""
    given = Path(os.environ[ZIP]).resolve()
    return next(given.glob("*.zip")) if given.is_dir() else given


def report(plate: str) -> dict[str, Any]:
    """Return what `crfnet estimate` reported of a plate."""
    path = files() / "expected" / Path(plate).with_suffix("") / f"{Path(plate).stem}.json"
    return json.loads(path.read_text(encoding="utf-8"))


@functools.cache
def screen(width: int, height: int) -> Screen:
    """Return a screen of this size, which runs until all cases are done."""
    running = Screen(width, height)
    atexit.register(running.close)
    return running


@functools.cache
def installed_home() -> Path:
    """Return a home in which the add-on was installed from its zip, once for all cases; they work on copies of it."""
    folder = Path(tempfile.mkdtemp(prefix="crf_home_"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    with Blender(os.environ[BLENDER], screen(*SIZES[1]), folder / "home") as blender:
        if not blender.call("runs.install", str(package())):
            raise RuntimeError(f"the add-on is not enabled: {blender.printed[-LAST:]}")
    return folder / "home"


def copy_home(source: Path, target: Path) -> None:
    """Copy a home; what extensions brought is linked, because it is large and nobody writes into it."""
    extensions = source / "blender" / "extensions"

    def copy(file: str, to: str) -> None:
        (os.link if extensions in Path(file).parents else shutil.copy2)(file, to)

    shutil.copytree(source, target, copy_function=copy, symlinks=True)
