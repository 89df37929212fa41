"""Measure time and memory, print the table and keep it in speed.json: `make bench`, or with names of some parts."""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import asdict
from datetime import date
from multiprocessing import get_context
from pathlib import Path

from benchmarks import calls, commands
from benchmarks.costs import Figure

#: Runs of each work.
RUNS = 5

RESULTS = Path(__file__).with_suffix(".json")

PARTS: dict[str, Callable[[Path, int], Iterator[Figure]]] = {
    "estimate": commands.estimate,
    "start": commands.start,
    "calls": calls.estimate_in_memory,
    "frame": calls.frame_in_memory,
    "each": commands.each,
    "linearize": commands.linearize,
}


def main(names: list[str]) -> None:
    """Measure the parts that are named, or all, each in a process of its own, whose memory no other has filled."""
    for name in names or PARTS:
        part = get_context("spawn").Process(target=measure, args=(name,))
        part.start()
        part.join()
        if part.exitcode:
            sys.exit(part.exitcode)


def measure(name: str) -> None:
    """Measure a part and replace its figures in `RESULTS`; other parts stay."""
    circumstances = _circumstances()
    with tempfile.TemporaryDirectory() as folder:
        figures = list(PARTS[name](Path(folder), RUNS))
    for figure in figures:
        print(f"{figure.name:<90}{figure.value:>8.2f} {figure.unit:<6}{figure.limit}", flush=True)
    kept = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    kept[name] = {**circumstances, "figures": [_rounded(asdict(each)) for each in figures]}
    RESULTS.write_text(json.dumps({each: kept[each] for each in PARTS if each in kept}, indent=2) + "\n")


def _circumstances() -> dict[str, object]:
    """Return when, where and of which commit the figures are."""
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False)
    names = [line.partition(":")[2].strip() for line in _lines("/proc/cpuinfo") if line.startswith("model name")]
    machine = f"{names[0] if names else platform.machine()}, {os.cpu_count()} cores, {platform.system()}"
    return {
        "date": date.today().isoformat(),
        "commit": commit.stdout.strip(),
        "machine": machine,
        "python": platform.python_version(),
        "runs": RUNS,
        "load average": os.getloadavg()[0],
    }


def _lines(path: str) -> list[str]:
    """Return the lines of a file, none if it is not there."""
    return Path(path).read_text().splitlines() if Path(path).exists() else []


def _rounded(value: object) -> object:
    """Return a document with its numbers rounded to four digits behind the point."""
    if isinstance(value, dict):
        return {name: _rounded(entry) for name, entry in value.items()}
    return round(float(value), 4) if isinstance(value, float) else value


if __name__ == "__main__":
    main(sys.argv[1:])
