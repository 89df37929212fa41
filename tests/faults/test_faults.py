"""A sample of the faults of `make faults`: whatever single call fails, files are whole or absent."""

import sys

import pytest

from tests.helpers.processes import ran


@pytest.mark.skipif(sys.platform != "linux", reason="needs fork and /proc")
def test_a_call_that_fails_leaves_whole_files_or_none(root):
    done = ran(sys.executable, "-m", "tests.faults", "--most", "4", cwd=root, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count(" cases\n") == 7
