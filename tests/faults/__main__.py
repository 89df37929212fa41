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
COMMAND = ("estimate", str(DATA / "plate.jpg"), "--model", str(DATA / "fixed_model"), "--out")


def run(out, injector=None, *more):
    """Return the exit code of an `estimate` in a process of its own (negative: a signal), its stderr and its calls."""
    stderr, calls = out.with_name("stderr"), out.with_name("calls")
    process = os.fork()
    if process == 0:
        os.dup2(os.open(stderr, os.O_CREAT | os.O_WRONLY | os.O_TRUNC), 2)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        if injector:
            injector.install()
        code = main([*COMMAND, str(out), *more])
        calls.write_text("\n".join(injector.calls if injector else []))
        os._exit(code)
    code = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
    return code, stderr.read_text(), calls.read_text().split() if calls.exists() else []


def final_files(out):
    """Return the files that have their names."""
    return {name: content for name, content in tree(out).items() if not name.startswith(".")} if out.exists() else {}


def problem_of(out, expected, fault, call):
    """Return the first thing that is wrong after a fault at a call, or an empty text."""
    code, stderr, _ = run(out, Injector(out, call=call, fault=fault))
    found = final_files(out)
    if fault is None:
        again = run(out, None, "--overwrite")[0]
        if not found.items() <= expected.items():
            return "a damaged file"
        return "" if again == 0 and final_files(out) == expected else f"the next run ends with {again}"
    if code == 0:
        return "" if found == expected else "exit code 0 without the whole set"
    if code != 2 or stderr.count("\n") != 1:
        return f"exit code {code}, stderr {stderr!r}"
    return "files are left" if out.exists() and any(out.iterdir()) else ""


def failures(folder, most):
    """Yield the failures of `most` cases, evenly over all (0: all), and in the end the number of cases."""
    (clean := folder / "clean" / "out").parent.mkdir()
    _, _, calls = run(clean, Injector(clean))
    numbered = [(name, 1 + calls[:number].count(name)) for number, name in enumerate(calls)]
    expected, cases = final_files(clean), [(call, fault) for call in numbered for fault in FAULTS]
    chosen = cases[:: max(1, len(cases) // most) if most else 1]
    for case, (call, fault) in enumerate(chosen):
        (out := folder / str(case) / "out").parent.mkdir()
        if problem := problem_of(out, expected, FAULTS[fault], call):
            yield f"{fault} at {call[0]} {call[1]}: {problem}"
    yield f"{len(chosen)} of {len(cases)} cases"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m tests.faults", description=__doc__)
    parser.add_argument("--most", type=int, default=0, metavar="N", help="cases, evenly over all; all by default")
    with tempfile.TemporaryDirectory() as name:
        lines = list(failures(Path(name), parser.parse_args().most))
    sys.stdout.write("".join(f"{line}\n" for line in lines))
    sys.exit(len(lines) > 1)
