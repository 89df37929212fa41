"""Run `estimate` once for each call and fault: ``python -m tests.faults [--most N]``; prints each failure."""

import argparse
import errno
import os
import sys
import tempfile
from pathlib import Path

from crfnet.cli.commands import estimate  # noqa: F401 - imported before the fork, which then is fast
from crfnet.cli.main import main
from tests.faults.injector import Injector
from tests.helpers.folders import tree

DATA = Path(__file__).parents[1] / "data"
FAULTS = {"EIO": errno.EIO, "ENOSPC": errno.ENOSPC, "SIGKILL": None}


def run(out, injector=None, *more):
    """Return the exit code of an `estimate` in a process of its own (negative: a signal), its stderr and its calls."""
    stderr, calls = out.with_name("stderr"), out.with_name("calls")
    process = os.fork()
    if process == 0:
        os.dup2(os.open(stderr, os.O_CREAT | os.O_WRONLY | os.O_TRUNC), 2)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        if injector:
            injector.install()
        code = main(
            ["estimate", str(DATA / "plate.jpg"), "--model", str(DATA / "fixed_model"), "--out", str(out), *more]
        )
        if injector and injector.fault is None:
            calls.write_text("\n".join(injector.calls))
        os._exit(code)
    code = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
    return code, stderr.read_text(), calls.read_text().split() if calls.exists() else []


def problem_of(out, expected, fault, number):
    """Return what is wrong after a fault at a call; an empty text if nothing is."""
    code, stderr, _ = run(out, Injector(out, number=number, fault=fault))
    found = tree(out) if out.exists() else {}
    if fault is None:
        final = {name: content for name, content in found.items() if not name.startswith(".")}
        again = run(out, None, "--overwrite")[0]
        if again or {name: found for name, found in tree(out).items() if not name.startswith(".")} != expected:
            return f"the run after it ends with {again}"
        return "a damaged file" if not final.items() <= expected.items() else ""
    if code == 0:
        return "" if found == expected else "exit code 0 without the whole set"
    if code != 2 or stderr.count("\n") != 1:
        return f"exit code {code}, stderr {stderr!r}"
    return f"left behind: {sorted(found)}" if found else ""


def failures(folder, most=0):
    """Yield the failures, and in the end the number of cases; `most` cases, evenly over all, if it is above 0."""
    clean = folder / "clean" / "out"
    clean.parent.mkdir()
    code, stderr, calls = run(clean, Injector(clean))
    assert code == 0, stderr
    expected, cases = tree(clean), [(number, name) for number in range(len(calls)) for name in FAULTS]
    step = max(1, len(cases) // most) if most else 1
    chosen = cases[::step]
    for case, (number, name) in enumerate(chosen):
        out = folder / str(case) / "out"
        out.parent.mkdir()
        if problem := problem_of(out, expected, FAULTS[name], number):
            yield f"{name} at call {number} ({calls[number]}): {problem}"
    yield f"{len(chosen)} of {len(cases)} cases"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m tests.faults", description=__doc__)
    parser.add_argument("--most", type=int, default=0, metavar="N", help="cases, evenly over all; all by default")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        lines = list(failures(Path(name), options.most))
    sys.stdout.write("".join(f"{line}\n" for line in lines))
    sys.exit(len(lines) > 1)
