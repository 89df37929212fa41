"""What a command or a call costs, in runs that take turns: whatever else the machine does disturbs all of them."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from statistics import median

import OpenImageIO

#: The programs of this environment; oiiotool is the binary, without the Python that the wheel starts it with.
PROGRAMS = Path(sys.executable).parent
OIIOTOOL = Path(OpenImageIO.__file__).parent / "bin" / "oiiotool"


@dataclass(frozen=True)
class Cost:
    """Wall and processor time in seconds, and peak resident memory in MB of a process (0 of a call)."""

    wall: float
    processor: float
    memory: float = 0.0


@dataclass(frozen=True)
class Figure:
    """One figure of the table: of the work, and what it may be at most, or at least; medians of several runs.

    Parameters
    ----------
    name : str
        What is measured, and against what.
    unit : str
        "times" (a ratio of wall times), "s" or "MB".
    value : float
        The figure.
    limit : str
        "at most 1.4"; empty without one.
    details : dict
        The costs that it is computed from, by name.
    """

    name: str
    unit: str
    value: float
    limit: str
    details: Mapping[str, object]


def cost_of_command(command: Sequence[str]) -> Cost:
    """Run a command, a program of this environment first, and return its cost."""
    program = OIIOTOOL if command[0] == "oiiotool" and OIIOTOOL.exists() else PROGRAMS / command[0]
    start = time.perf_counter()
    process = subprocess.Popen([str(program), *command[1:]], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.perf_counter() - start
    if status:
        sys.exit(f"failed: {' '.join(command)}")
    scale = 1 if sys.platform == "darwin" else 1024
    return Cost(wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * scale / 1e6)


def cost_of_call(function: Callable[[], object]) -> Cost:
    """Call a function and return its cost."""
    start, processor = time.perf_counter(), time.process_time()
    function()
    return Cost(time.perf_counter() - start, time.process_time() - processor)


def medians(works: Mapping[str, Callable[[], Cost]], runs: int) -> dict[str, Cost]:
    """Return the median cost of each work; the runs take turns."""
    costs: dict[str, list[Cost]] = {name: [] for name in works}
    for name in [*works] * runs:
        costs[name].append(works[name]())
    return {
        name: Cost(*(median(getattr(cost, part.name) for cost in found) for part in fields(Cost)))
        for name, found in costs.items()
    }


def ratio(name: str, limit: str, costs: Mapping[str, Cost]) -> Figure:
    """Return how many times the second of two costs the first is, in wall time; the details say processor time, too."""
    work, reference = costs.values()
    details: dict[str, object] = {each: asdict(cost) for each, cost in costs.items()}
    details["processor times"] = round(work.processor / reference.processor, 3)
    return Figure(name, "times", work.wall / reference.wall, limit, details)
