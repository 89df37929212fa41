"""One command to run, what it has to leave, and what is wrong if it does not."""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PLATE = ROOT / "tests" / "data" / "plate.jpg"
MODEL = ROOT / "tests" / "data" / "fixed_model"

#: How many frames `linearize` has.
FRAMES = 12

#: How the names of temporary files begin.
_TEMPORARY = "."


@dataclass(frozen=True)
class Row:
    """A row of the table: what was tried, how often, and what went wrong."""

    what: str
    cases: int
    failures: tuple[str, ...]
    note: str = ""


@dataclass(frozen=True)
class Trial:
    """A command that writes files into a folder of its own.

    Parameters
    ----------
    name : str
        Of the subcommand.
    arguments : callable
        Folder -> the arguments of `crfnet` that write there.
    expected : dict
        What an undisturbed run writes: name -> bytes.
    seconds : float
        How long that took.
    is_set : bool
        Whether the files appear together, or one by one.
    """

    name: str
    arguments: Callable[[Path], list[str]]
    expected: dict[str, bytes] = field(default_factory=dict)
    seconds: float = 0.0
    is_set: bool = True

    def command(self, out: Path) -> list[str]:
        """Return the command line that writes into a folder."""
        return [sys.executable, "-m", "crfnet.cli.main", *self.arguments(out)]

    def run(self, out: Path) -> subprocess.CompletedProcess[str]:
        """Run it to its end."""
        return subprocess.run(self.command(out), cwd=ROOT, capture_output=True, text=True, check=False)

    def is_whole(self, out: Path) -> bool:
        """Return whether every file is there."""
        return set(self.expected) <= files(out).keys()

    def wrong_files(self, out: Path) -> Iterator[str]:
        """Yield what is wrong with the files that have their final names."""
        found = files(out)
        yield from (f"{name} has other bytes" for name in found if found[name] != self.expected.get(name))
        if self.is_set and found and not self.is_whole(out):
            yield f"{len(found)} of {len(self.expected)} files"

    def leftovers(self, out: Path) -> Iterator[str]:
        """Yield temporary files and folders."""
        if out.is_dir():
            yield from (f"{path.name} is left" for path in out.iterdir() if path.name.startswith(_TEMPORARY))


def files(out: Path) -> dict[str, bytes]:
    """Return the files of a folder that have their final names: name -> bytes."""
    paths = out.iterdir() if out.is_dir() else ()
    return {path.name: path.read_bytes() for path in paths if not path.name.startswith(_TEMPORARY)}


def make_trials(work: Path) -> tuple[Trial, ...]:
    """Return a trial of `estimate` and one of `linearize`, with the files that an undisturbed run writes."""
    frames = work / "frames"
    frames.mkdir(parents=True)
    for number in range(1, FRAMES + 1):
        shutil.copy(PLATE, frames / f"plate.{number:04d}.jpg")
    lut = work / "identity.cube"
    lut.write_text("LUT_1D_SIZE 2\n0 0 0\n1 1 1\n", encoding="utf-8")

    def estimate(out: Path) -> list[str]:
        return ["estimate", str(PLATE), "--model", str(MODEL), "--out", str(out)]

    def linearize(out: Path) -> list[str]:
        plates, targets = frames / "plate.%04d.jpg", out / "linear.%04d.exr"
        return ["linearize", str(plates), "--lut", str(lut), "--out", str(targets)]

    return _measured(work, "estimate", estimate, is_set=True), _measured(work, "linearize", linearize, is_set=False)


def _measured(work: Path, name: str, arguments: Callable[[Path], list[str]], *, is_set: bool) -> Trial:
    """Return a trial with what an undisturbed run writes and the time that it takes."""
    out = work / f"expected_{name}"
    trial = Trial(name, arguments)
    begin = time.monotonic()
    done = trial.run(out)
    if done.returncode:
        raise SystemExit(f"{name} fails undisturbed: {done.stderr}")
    return Trial(name, arguments, files(out), time.monotonic() - begin, is_set)
