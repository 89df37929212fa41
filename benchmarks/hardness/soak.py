"""Many estimates in one process: memory, open files and threads must not grow.

Run as a program, it prints one line after each estimate: resident memory in bytes, open files, threads. Linux only.
"""

from __future__ import annotations

import contextlib
import io
import os
import statistics
import subprocess
import sys
import threading
from pathlib import Path

from benchmarks.hardness.trial import MODEL, PLATE, ROOT, Row

#: How much more memory the last quarter of the runs may have than the second, and from which run on files are counted.
MOST_GROWTH, WARM = 1.1, 10


def soak(count: int, work: Path) -> Row:
    """Return the row of `count` estimates in one process."""
    what = "estimates in one process: memory, open files, Python threads"
    if not sys.platform.startswith("linux"):
        return Row(what, 0, (), "skipped: memory is read from /proc, which only Linux has")
    command = [sys.executable, "-m", "benchmarks.hardness.soak", str(count), str(work)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    lines = [tuple(map(int, line.split())) for line in done.stdout.splitlines()]
    if done.returncode or len(lines) != count:
        return Row(what, len(lines), (f"ended after {len(lines)}: {done.stderr.strip()[-200:]!r}",))
    memory, opened, threads = zip(*lines, strict=True)
    failures = []
    warm = min(WARM, count) - 1
    early = statistics.median(memory[count // 4 : count // 2] or memory)
    late = statistics.median(memory[-(count // 4) :] or memory)
    if late > MOST_GROWTH * early:
        failures.append(f"memory grows from {early / 2**20:.0f} to {late / 2**20:.0f} MB")
    for name, counted in (("open files", opened), ("Python threads", threads)):
        if counted[-1] > counted[warm]:
            failures.append(f"{name} grow from {counted[warm]} to {counted[-1]}")
    note = (
        f"{early / 2**20:.0f} MB in the second quarter, {late / 2**20:.0f} MB in the last;"
        f" {opened[warm]} open files and {threads[warm]} Python threads early, {opened[-1]} and {threads[-1]} late"
    )
    return Row(what, count, tuple(failures), note)


def main(count: int, work: Path) -> None:
    """Estimate the bundled photograph `count` times, through the command's own entry."""
    from crfnet.cli.main import main as crfnet

    for _ in range(count):
        arguments = ["estimate", PLATE, "--model", MODEL, "--out", work / "soak", "--overwrite", "--no-sheet"]
        with contextlib.redirect_stdout(io.StringIO()):
            code = crfnet([str(argument) for argument in arguments])
        if code:
            raise SystemExit(f"crfnet ends with {code}")
        pages = int(Path("/proc/self/statm").read_text(encoding="utf-8").split()[1])
        opened = len(os.listdir("/proc/self/fd"))  # noqa: PTH208 - counts the folder itself, every time alike
        sys.stdout.write(f"{pages * os.sysconf('SC_PAGE_SIZE')} {opened} {threading.active_count()}\n")


if __name__ == "__main__":
    main(int(sys.argv[1]), Path(sys.argv[2]))
