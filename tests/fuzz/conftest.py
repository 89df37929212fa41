"""Fuzzing: every test tries damaged files for a while, with other seeds in each run, and names those that fail.

`CRFNET_FUZZ_SECONDS` says how long each test goes on; `make fuzz` gives them an hour together. `CRFNET_FUZZ_SEED` is
the seed to begin with, to try one again. A single case that hangs ends everything with a traceback. The last lines
count the cases of each test.
"""

import faulthandler
import os
import secrets
import sys
import time
import traceback
import warnings
from itertools import count

import numpy as np
import pytest

from crfnet_core.errors import CRFNetError
from tests.helpers.memory import peak_of_now

#: The first seed; seconds of each test, and of a single case.
FIRST_SEED = int(os.environ.get("CRFNET_FUZZ_SEED") or secrets.randbelow(2**32))
SECONDS = float(os.environ.get("CRFNET_FUZZ_SECONDS", "2"))
MOST_SECONDS = 20.0

#: Bytes of memory beyond those at the start of a case.
MOST_MEMORY = 2**30


def pytest_terminal_summary(terminalreporter):
    """Print how many cases each test has tried."""
    reports = [report for outcome in ("passed", "failed") for report in terminalreporter.getreports(outcome)]
    for report in reports:
        if cases := dict(report.user_properties).get("cases"):
            terminalreporter.write_line(f"{cases:8d} cases: {report.head_line}")


@pytest.fixture
def fuzz(record_property, capsys):
    """Call a case with a generator of every seed until the time is up: fuzz(case)."""

    def run(case):
        failures, begin = [], time.monotonic()
        for seed in count(FIRST_SEED):
            if (began := time.monotonic()) > begin + SECONDS:
                break
            faulthandler.dump_traceback_later(3 * MOST_SECONDS, exit=True, file=sys.__stderr__)
            peak_of_now()
            memory = peak_of_now()
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("error")
                    case(np.random.default_rng(seed))
                assert time.monotonic() - began < MOST_SECONDS, "took too long"
                assert peak_of_now() - memory < MOST_MEMORY, "took too much memory"
                assert capsys.readouterr() == ("", ""), "printed something"
            except Exception as problem:  # noqa: BLE001 - whatever is raised is a finding
                place = traceback.extract_tb(problem.__traceback__)[-1]
                failures.append(
                    f"CRFNET_FUZZ_SEED={seed}: {type(problem).__name__} in {place.name}, {place.filename}: {problem}"
                )
        faulthandler.cancel_dump_traceback_later()
        cases = seed - FIRST_SEED
        record_property("cases", cases)
        record_property("failures", len(failures))
        assert cases > 0
        assert not failures, f"{len(failures)} of {cases}:\n" + "\n".join(failures[:20])

    return run


@pytest.fixture
def refused():
    """Whether reading a file is refused in one line that names it; other errors pass through: refused(read, path)."""

    def is_refused(read, path):
        try:
            read(path)
        except CRFNetError as problem:
            line = str(problem)
        else:
            return False
        assert str(path) in line, f"does not name the file: {line}"
        assert line.isprintable(), f"is not a plain line: {line!r}"
        return True

    return is_refused
