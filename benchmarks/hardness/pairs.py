"""Two runs at once in one folder: every file is whole, and no run complains of what the other has finished."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.hardness.trial import ROOT, Row, Trial


def pair(trials: Sequence[Trial], count: int, work: Path) -> Iterator[Row]:
    """Yield a row for each trial, from `count` pairs of the same command.

    Of two estimates at most one may be refused; of two runs of `linearize` none.
    """
    for trial in trials:
        failures = []
        for case in range(count):
            out = work / f"pair_{trial.name}_{case}"
            runs = [
                subprocess.Popen(
                    trial.command(out), cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
                )
                for _ in range(2)
            ]
            errors = [run.communicate()[1] for run in runs]
            codes = sorted(run.returncode for run in runs)
            problems = [*trial.wrong_files(out), *trial.leftovers(out)]
            if codes != [0, 0] and not (trial.is_set and codes == [0, 2]):
                problems.append(f"exit codes {codes}, stderr {errors}")
            if not trial.is_whole(out):
                problems.append("files are missing")
            failures += problems[:1]
            shutil.rmtree(out, ignore_errors=True)
        yield Row(f"two `{trial.name}` at once in one folder", count, tuple(failures))
