"""The tests of tests/fuzz, for as long as one likes."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

from benchmarks.hardness.trial import ROOT, Row

#: How many tests share the time.
TESTS = 9


def fuzz(seconds: float, work: Path) -> Iterator[Row]:
    """Yield a row for each test, after `seconds` for all of them."""
    report = work / "fuzz.xml"
    environment = {**os.environ, "CRFNET_FUZZ_SECONDS": str(seconds / TESTS)}
    command = [sys.executable, "-m", "pytest", "tests/fuzz", "-q", f"--junitxml={report}"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, env=environment)
    if not report.exists():  # the process itself has ended
        yield Row("damaged files", 0, (f"pytest ends with {done.returncode}: {done.stdout.strip()[-300:]!r}",))
        return
    for test in ElementTree.parse(report).iter("testcase"):
        counted = {each.get("name"): int(each.get("value", 0)) for each in test.iter("property")}
        problem = test.find("failure")
        failures = () if problem is None else (problem.get("message", "")[:500],) * max(1, counted.get("failures", 1))
        name = test.get("name", "").removeprefix("test_").replace("_", " ")
        yield Row(name, counted.get("cases", 0), failures)
