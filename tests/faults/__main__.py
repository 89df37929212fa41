"""Run each command once for each call and fault: ``python -m tests.faults [--most N]``; prints each failure."""

import argparse
import errno
import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crfnet.cli.commands import calibrate, camera, config, estimate, linearize  # noqa: F401 - before the fork: fast
from crfnet.cli.main import main
from crfnet.defaults import CONFIG_NAME, ESTIMATES
from crfnet_core.response.curve import ResponseCurve
from tests.faults.injector import SHORT, Injector
from tests.helpers.folders import tree
from tests.helpers.images import read_image
from tests.helpers.stacks import StackOptions, make_stack

DATA = Path(__file__).parents[1] / "data"
MODEL = ("--model", str(DATA / "fixed_model"))
FAULTS = {"EIO": errno.EIO, "ENOSPC": errno.ENOSPC, "SHORT": SHORT, "SIGKILL": None}


@dataclass(frozen=True)
class Command:
    """A command: its arguments for an output folder, and how it goes on.

    `is_set`: its files appear together, and after SIGKILL it may need --overwrite. `growing`: files that it changes.
    `earlier`: the folder of inputs with the files that are there at the start.
    """

    arguments: Callable[[Path, Path], list[object]]
    is_set: bool = True
    growing: tuple[str, ...] = ()
    earlier: str = ""


COMMANDS = {
    "estimate": Command(lambda inputs, out: ["estimate", inputs / "a.1.jpg", "--no-sheet", *MODEL, "--out", out]),
    "estimate --overwrite": Command(
        lambda inputs, out: [
            *(
                "estimate",
                inputs / "a.1.jpg",
                "--no-sheet",
                *MODEL,
                "--taken-with",
                "phone",
                "--overwrite",
                "--out",
                out,
            )
        ],
        earlier="look",
    ),
    "calibrate": Command(
        lambda inputs, out: ["calibrate", *sorted(inputs.glob("stack/*")), "--no-sheet", "--name", "cam", "--out", out]
    ),
    "config add": Command(
        lambda inputs, out: ["config", "add", "--base", inputs / "look" / CONFIG_NAME, "--out", out, inputs / "look"]
    ),
    "camera add": Command(lambda inputs, _: ["camera", "add", "--from-calibration", inputs / "cam" / "cam.json"]),
    "linearize": Command(
        lambda inputs, out: [
            *("linearize", inputs / "a.%d.jpg", "--lut", inputs / "look" / "a.1.spi1d", "--out", out / "a.%d.exr")
        ],
        is_set=False,
    ),
    "--each": Command(
        lambda inputs, out: [
            *("estimate", "--each", *inputs.glob("a.*.jpg"), "--workers", 1, "--no-sheet", *MODEL, "--out", out)
        ],
        is_set=False,
        growing=(ESTIMATES, CONFIG_NAME),
    ),
}


def run(arguments, out, injector=None):
    """Return the exit code of a command in a process of its own (negative: a signal), its stderr and its calls."""
    stderr, calls = out.with_name("stderr"), out.with_name("calls")
    process = os.fork()
    if process == 0:
        os.sched_getaffinity = lambda _: {0}  # one worker: the same calls each time
        os.environ["CRFNET_DATA_DIR"] = str(out)
        os.dup2(os.open(stderr, os.O_CREAT | os.O_WRONLY | os.O_TRUNC), 2)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        if injector:
            injector.install()
        code = main([str(each) for each in arguments])
        calls.write_text("\n".join(injector.calls if injector else []))
        os._exit(code)
    code = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
    return code, stderr.read_text(), calls.read_text().split() if calls.exists() else []


def final_files(out, without=()):
    """Return the files that have their names."""
    files = tree(out) if out.exists() else {}
    return {
        name: content
        for name, content in files.items()
        if not any(part.startswith(".") for part in Path(name).parts) and name not in without
    }


def problem_of(command, inputs, out, expected, fault, call):
    """Return the first thing that is wrong after a fault at a call, or an empty text."""
    arguments = command.arguments(inputs, out)
    code, stderr, _ = run(arguments, out, Injector(out, call=call, fault=fault))
    found, first = final_files(out, command.growing), final_files(expected, command.growing)
    earlier = final_files(inputs / command.earlier) if command.earlier else {}
    if any(content not in (first.get(name), earlier.get(name)) for name, content in found.items()):
        return "a damaged file"
    if code == 0 and found != first:
        return "exit code 0 without all files"
    if fault is not None and code != 0 and (code != 2 or stderr.count("\n") != 1):
        return f"exit code {code}, stderr {stderr!r}"
    if code == 2 and command.is_set and found != earlier:
        return f"files are left, or earlier ones gone: {', '.join(found)}"
    again, stderr, _ = run([*arguments, *(["--overwrite"] if command.is_set and found else [])], out)
    if again or final_files(out, command.growing[:1]) != final_files(expected, command.growing[:1]):
        return f"the next run ends with {again}, {stderr!r}"
    return f"a temporary folder stays after exit code {code}" if any(out.rglob(".crfnet-*")) else ""


def prepare(inputs):
    """Make the photographs, a stack, an estimate and a calibration."""
    (inputs / "stack").mkdir(parents=True)
    for number in (1, 2):
        shutil.copy(DATA / "plate.jpg", inputs / f"a.{number}.jpg")
    light = read_image(DATA / "lights" / "interior.exr")[::4, ::4, :3]
    response = ResponseCurve.from_samples(np.loadtxt(DATA / "plate_response.csv", delimiter=",", skiprows=1)[:, 1])
    make_stack(inputs / "stack", light, response, StackOptions(frames=5, quality=0), Make="A")
    for name, folder in (("estimate", "look"), ("calibrate", "cam")):
        code, stderr, _ = run(COMMANDS[name].arguments(inputs, inputs / folder), inputs / folder)
        assert code == 0, stderr


def prepared(command, inputs, out):
    """Return an output folder, which is absent or holds earlier files."""
    out.parent.mkdir(parents=True)
    if command.earlier:
        shutil.copytree(inputs / command.earlier, out)
    return out


def failures(name, inputs, folder, most):
    """Yield the failures of `most` cases of a command, evenly over all (0: all), and in the end their number."""
    command = COMMANDS[name]
    clean = prepared(command, inputs, folder / "clean" / "out")
    code, stderr, calls = run(command.arguments(inputs, clean), clean, Injector(clean))
    assert code == 0, stderr
    numbered = [(call, 1 + calls[:number].count(call)) for number, call in enumerate(calls)]
    cases = [(call, fault) for call in numbered for fault in FAULTS if fault != "SHORT" or call[0] == "write"]
    chosen = cases[:: max(1, len(cases) // most) if most else 1]
    for case, (call, fault) in enumerate(chosen):
        out = prepared(command, inputs, folder / str(case) / "out")
        if problem := problem_of(command, inputs, out, clean, FAULTS[fault], call):
            yield f"{name}: {fault} at {call[0]} {call[1]}: {problem}"
        shutil.rmtree(out.parent)
    yield f"{name}: {len(chosen)} of {len(cases)} cases"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m tests.faults", description=__doc__)
    parser.add_argument(
        "--most", type=int, default=0, metavar="N", help="cases of each, evenly over all; all by default"
    )
    parser.add_argument("commands", nargs="*", metavar="COMMAND", help="of estimate, 'config add' ...; all by default")
    options, is_bad = parser.parse_args(), False
    with tempfile.TemporaryDirectory() as name:
        prepare(Path(name, "inputs"))
        for command in options.commands or COMMANDS:
            for line in failures(command, Path(name, "inputs"), Path(name, command), options.most):
                sys.stdout.write(f"{line}\n")
                sys.stdout.flush()
                is_bad |= not line.endswith(" cases")
    sys.exit(is_bad)
