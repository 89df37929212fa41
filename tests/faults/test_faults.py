"""A sample of the faults of `make faults`: whatever single call fails, files are whole or absent."""

import subprocess
import sys

import pytest


@pytest.mark.skipif(sys.platform != "linux", reason="needs fork and /proc")
def test_a_call_that_fails_leaves_whole_files_or_none(root):
    command = [sys.executable, "-m", "tests.faults", "--most", "4"]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count(" cases\n") == 6
