"""Nothing leaves the machine and nothing is left in the user's home folder."""

import os
import sys

import pytest

from tests.helpers.no_sockets import IS_AVAILABLE, OPENED_A_SOCKET, run_without_sockets

pytestmark = pytest.mark.skipif(not IS_AVAILABLE, reason="needs Linux on x86-64 or 64-bit ARM, to see every socket")

#: Estimate at the start and 15 s later: onnxruntime's telemetry looks its host up after 10 s.
ESTIMATE_FOR_15_S = """
import sys, time
from crfnet_core import ResponseNetwork, estimate_response, read_photo
start = time.monotonic()
photo, network = read_photo(sys.argv[1]), ResponseNetwork.load()
estimate_response(photo, network=network)
time.sleep(max(0, start + 15 - time.monotonic()))
estimate_response(photo, network=network)
print("estimated twice")
"""


@pytest.fixture
def environment(tmp_path, root):
    """A new user's environment: an empty home folder, and every other folder that a program may write to below it."""
    (tmp_path / "tmp").mkdir()
    return {"PATH": os.environ["PATH"], "HOME": str(tmp_path), "TMPDIR": str(tmp_path / "tmp"), "PYTHONPATH": str(root)}


@pytest.mark.parametrize("call", ["socket()", "getaddrinfo('host.invalid', 80)"])
def test_a_socket_does_not_go_unnoticed(call, environment):
    """Otherwise the test below could not fail."""
    command = [sys.executable, "-c", f"import socket; socket.{call}"]
    assert run_without_sockets(command, env=environment).returncode == OPENED_A_SOCKET


def test_an_estimate_opens_no_socket_and_leaves_no_file(plate, environment, tmp_path):
    command = [sys.executable, "-c", ESTIMATE_FOR_15_S, plate]
    done = run_without_sockets(command, env=environment, cwd=tmp_path, timeout=120)
    assert done.returncode != OPENED_A_SOCKET, "it opened a socket"
    assert (done.returncode, done.stdout) == (0, "estimated twice\n"), done.stderr
    assert [path for path in tmp_path.rglob("*") if path != tmp_path / "tmp"] == []
