"""Run the cases: ``python3 -m tests.blender_window --blender blender --zip ZIP --files FOLDER --pictures FOLDER``."""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import unittest
from pathlib import Path

from tests.blender_window import base
from tests.blender_window.screen import PROGRAMS

#: The pictures for the add-on's README and their names there; all of them together have at most so many bytes.
README_PICTURES = {
    "panel_before_dark_1x": "panel.png",
    "panel_usable_dark_1x": "estimate.png",
    "panel_do_not_trust_dark_1x": "do_not_trust.png",
}
MOST_BYTES = 300_000

#: This folder, and the project's.
HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent


class _Result(unittest.TextTestResult):
    """Tells what failed at once, because the last case ends long after the first."""

    def addError(self, test, err):
        super().addError(test, err)
        self.stream.writeln(self.errors[-1][1])

    def addFailure(self, test, err):
        super().addFailure(test, err)
        self.stream.writeln(self.failures[-1][1])


def main() -> int:
    """Run the cases that the command line names, all by default; return 0 if none failed, or if they are skipped."""
    options = _parser().parse_args()
    if lacking := _lacking(options):
        print(f"SKIPPED: the tests with Blender's window need {lacking}")
        return 0
    os.environ[base.BLENDER] = options.blender
    os.environ[base.ZIP] = str(options.zip)
    os.environ[base.FILES] = str(options.files)
    os.environ[base.PICTURES] = str(options.pictures)
    loader = unittest.TestLoader()
    if options.only:
        cases = loader.loadTestsFromNames([f"tests.blender_window.{name}" for name in options.only])
    else:
        cases = loader.discover(str(HERE), top_level_dir=str(ROOT))
    result = unittest.TextTestRunner(verbosity=2, resultclass=_Result).run(cases)
    print(f"The pictures are in {options.pictures}: look at them")
    if options.readme:
        _copy_pictures(options.pictures, options.readme)
    return 0 if result.wasSuccessful() else 1


def _copy_pictures(source: Path, target: Path) -> None:
    """Copy the pictures for the README."""
    sizes = [(source / f"{name}.png").stat().st_size for name in README_PICTURES]
    if sum(sizes) > MOST_BYTES:
        sys.exit(f"the pictures for the README have {sum(sizes)} bytes, more than {MOST_BYTES}")
    target.mkdir(parents=True, exist_ok=True)
    for name, new in README_PICTURES.items():
        shutil.copyfile(source / f"{name}.png", target / new)
    print(f"{len(sizes)} pictures with {sum(sizes)} bytes are copied to {target}")


def _lacking(options: argparse.Namespace) -> str:
    """Return what the cases need and is not there, in words; an empty text if nothing is missing."""
    if not options.blender:
        return "BLENDER=path of a Blender, such as BLENDER=/usr/bin/blender"
    if absent := [name for name in (options.blender, *PROGRAMS) if shutil.which(name) is None]:
        return f"{', '.join(absent)} on the path (Debian: apt install blender xvfb xdotool)"
    return ""


def _parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(prog="python3 -m tests.blender_window", description=__doc__)
    parser.add_argument("only", nargs="*", help="modules or cases, such as test_button (default: all)")
    parser.add_argument("--blender", default="", help="Blender's executable")
    parser.add_argument("--zip", type=Path, required=True, help="the extension's zip for this platform, or its folder")
    parser.add_argument("--files", type=Path, required=True, help="the folder that make_files has written")
    parser.add_argument("--pictures", type=Path, required=True, help="the folder for pictures")
    parser.add_argument("--readme", type=Path, help="the folder for copies of those that the add-on's README shows")
    return parser


if __name__ == "__main__":
    sys.exit(main())
