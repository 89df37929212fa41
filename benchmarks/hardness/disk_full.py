"""A run that finds no room: on a small file system, and under a limit of the size of a file."""

from __future__ import annotations

import random
import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from benchmarks.hardness.trial import ROOT, Row, Trial

#: Exit code of a refusal.
REFUSED = 2


def fill(trials: Sequence[Trial], count: int, work: Path) -> Iterator[Row]:
    """Yield a row for each trial and way of having no room, from `count` runs each."""
    for trial in trials:
        sizes = _sizes(trial, count)
        yield _row(trial, f"`{trial.name}` with files limited in size", sizes, work, _run_limited)
        can_mount = _mounted(work / "probe", 1 << 20)
        if can_mount:
            _unmounted(work / "probe")
            yield _row(trial, f"`{trial.name}` on a full file system", sizes, work, _run_on_small_disk)
        else:
            yield Row(f"`{trial.name}` on a full file system", 0, (), "skipped: mounting a tmpfs needs root")


def _sizes(trial: Trial, count: int) -> list[int]:
    """Return sizes from 1 KB to somewhat more than what is written, evenly on a logarithmic scale."""
    total = sum(map(len, trial.expected.values()))
    return [int(1024 * (1.2 * total / 1024) ** random.Random(case).random()) for case in range(count)]


def _row(trial: Trial, what: str, sizes: Sequence[int], work: Path, run: Callable[[Trial, Path, int], str]) -> Row:
    """Return the row of runs with room of some sizes."""
    failures = []
    for size in sizes:
        folder = work / f"full_{trial.name}"
        folder.mkdir()
        problem = run(trial, folder, size)
        failures += [f"{size} bytes: {problem}"] if problem else []
        shutil.rmtree(folder)
    return Row(what, len(sizes), tuple(failures), "a whole set or nothing" if trial.is_set else "whole frames alone")


def _run_limited(trial: Trial, folder: Path, size: int) -> str:
    """Run with files of at most `size` bytes and return what is wrong."""
    import resource

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    return _problem(trial, folder / "out", preexec_fn=limit)


def _run_on_small_disk(trial: Trial, folder: Path, size: int) -> str:
    """Run on a file system of `size` bytes and return what is wrong."""
    if not _mounted(folder, size):
        return "the file system cannot be mounted"
    try:
        return _problem(trial, folder / "out")
    finally:
        _unmounted(folder)


def _problem(trial: Trial, out: Path, *, preexec_fn: Callable[[], None] | None = None) -> str:
    """Run a trial without room and return what is wrong, or an empty text."""
    done = subprocess.run(
        trial.command(out), cwd=ROOT, capture_output=True, text=True, check=False, preexec_fn=preexec_fn
    )
    problems = [*trial.wrong_files(out), *trial.leftovers(out)]
    if done.returncode not in (0, REFUSED) or done.stderr.count("\n") != (done.returncode == REFUSED):
        problems.append(f"exit code {done.returncode}, stderr {done.stderr.strip()[-200:]!r}")
    if done.returncode == 0 and not trial.is_whole(out):
        problems.append("files are missing though it says nothing")
    return "; ".join(problems)


def _mounted(folder: Path, size: int) -> bool:
    """Mount a tmpfs and return whether that is possible."""
    folder.mkdir(exist_ok=True)
    command = ["mount", "-t", "tmpfs", "-o", f"size={size}", "crfnet", str(folder)]
    try:
        return subprocess.run(command, capture_output=True, check=False).returncode == 0
    except FileNotFoundError:
        return False


def _unmounted(folder: Path) -> None:
    """Unmount it."""
    subprocess.run(["umount", str(folder)], check=True)
