"""A run that a signal ends at a random time, and the run after it, which has to complete without --overwrite."""

from __future__ import annotations

import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.hardness.trial import ROOT, Row, Trial

#: The command, which says when it begins.
RUN = "import sys, crfnet.cli.main; print('ready', flush=True); sys.exit(crfnet.cli.main.main())"

SIGNALS = (signal.SIGKILL, signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def kill(trials: Sequence[Trial], count: int, work: Path) -> Iterator[Row]:
    """Yield a row for each trial and signal, from `count` runs each."""
    times = random.Random(0)
    for trial in trials:
        for number in SIGNALS:
            failures: list[str] = []
            ended = 0
            for case in range(count):
                out = work / f"{trial.name}_{number.name}_{case}"
                delay = times.uniform(0, trial.seconds)
                code, error = _killed(trial, out, number, delay)
                ended += code != 0
                problems = [
                    *_wrong_end(trial, out, number, code, error),
                    *_wrong_files(trial, out, number),
                    *_wrong_rerun(trial, out),
                ]
                failures += [f"after {delay:.2f} s: {problem}" for problem in problems[:1]]
                shutil.rmtree(out, ignore_errors=True)
            note = f"{ended} hit before the end, {len(trial.expected)} files each"
            yield Row(f"{number.name} during `{trial.name}`, then the same command again", count, tuple(failures), note)


def _killed(trial: Trial, out: Path, number: signal.Signals, delay: float) -> tuple[int, str]:
    """Start a run, end it a time after its first line of code, and return its exit code and its stderr.

    Before that line Python itself starts, and dies of a signal in its own way.
    """
    process = subprocess.Popen(
        [sys.executable, "-c", RUN, *trial.arguments(out)],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=_restored,
    )
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(delay)
    process.send_signal(number)
    return _ended(process)


def _restored() -> None:
    """Let the signals do in the run what they do by default, whatever the shell ignores."""
    for number in SIGNALS[1:]:
        signal.signal(number, signal.SIG_DFL)


def _ended(process: subprocess.Popen[str]) -> tuple[int, str]:
    """Return the exit code and stderr of a run that has to end soon."""
    try:
        _, error = process.communicate(timeout=60)
    except subprocess.TimeoutExpired:
        process.kill()
        return -1, f"it still ran after a minute{process.communicate()[1]}"
    return process.returncode, error


def _wrong_end(trial: Trial, out: Path, number: signal.Signals, code: int, error: str) -> Iterator[str]:
    """Yield what is wrong with an exit code and a message; when all is written, Python ends in its own way again."""
    allowed = {(0, ""), (128 + number, "crfnet: interrupted\n")}
    if number == signal.SIGKILL or trial.is_whole(out):
        allowed.add((-number, ""))
    if (code, error) not in allowed:
        yield f"exit code {code}, stderr {error.strip()[-200:]!r}"


def _wrong_files(trial: Trial, out: Path, number: signal.Signals) -> Iterator[str]:
    """Yield what is wrong with what is left; only SIGKILL may leave temporary files."""
    yield from trial.wrong_files(out)
    if number != signal.SIGKILL:
        yield from trial.leftovers(out)


def _wrong_rerun(trial: Trial, out: Path) -> Iterator[str]:
    """Yield what is wrong after the same command again, unless the first run was complete."""
    if trial.is_whole(out):
        return
    done = trial.run(out)
    if done.returncode:
        yield f"the second run ends with {done.returncode}: {done.stderr.strip()[-200:]!r}"
    yield from trial.wrong_files(out)
    if not trial.is_whole(out):
        yield "files are missing after the second run"
