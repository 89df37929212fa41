"""The installed command, in a process of its own."""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from crfnet.cli.arguments.parts import BAD_INPUT
from crfnet.cli.commands import printing
from tests.helpers.folders import listed, tree
from tests.helpers.processes import ran, start_interruptible

CRFNET = Path(sys.executable).with_name("crfnet")

#: Run the command, which says "ready" and waits where it would write the config.
WAITING = (
    "import sys, time, crfnet.pipeline.delivery as f, crfnet.cli.main;"
    "f.write_config = lambda *a, **k: (print('ready', flush=True), time.sleep(60));"
    "sys.exit(crfnet.cli.main.main(sys.argv[1:]))"
)


@pytest.fixture
def arguments(plate, fixed_model, tmp_path):
    return ["estimate", plate, "--out", tmp_path / "out", "--model", fixed_model]


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such names")
def test_refuses_names_that_are_no_text(plate, fixed_model, tmp_path):
    photo = tmp_path / os.fsdecode(b"\xff.jpg")
    shutil.copy(plate, photo)
    command = [CRFNET, "estimate", photo, "--out", tmp_path / "out", "--model", fixed_model]
    done = ran(*command)
    assert done.returncode == BAD_INPUT
    assert done.stderr == f"crfnet: error: {tmp_path}/\\udcff.jpg: the name is not valid Unicode; rename it\n"
    assert not (tmp_path / "out").exists()
    environment = os.environ | {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    done = ran(*command, env=environment)
    assert done.stderr.endswith("is not text in ascii, which the environment states; set LC_ALL=C.UTF-8\n")


def test_a_reader_that_leaves_is_no_error_message(look):
    assert ran(f"'{CRFNET}' info '{look / 'plate.spi1d'}' | true", shell=True).stderr == ""


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGXCPU", "SIGUSR1", "SIGUSR2"])
def test_a_signal_leaves_nothing_and_no_traceback(arguments, tmp_path, name):
    number = getattr(signal, name)
    command = [sys.executable, "-c", WAITING, *arguments]
    with start_interruptible(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        process.stdout.readline()
        time.sleep(0.1)
        process.send_signal(number)
        process.send_signal(number)
        _, err = process.communicate(timeout=20)
    assert (process.returncode, err) == (128 + number, "crfnet: interrupted\n")
    assert not (tmp_path / "out").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
def test_control_c_during_the_imports_leaves_no_traceback(look):
    code = (
        "import sys, crfnet.cli.main;"
        "import_module = crfnet.cli.main.import_module;"
        "crfnet.cli.main.import_module = lambda name: (print('ready', flush=True), import_module(name))[1];"
        "sys.exit(crfnet.cli.main.main(sys.argv[1:]))"
    )
    command = [sys.executable, "-c", code, "info", look / "plate.spi1d"]
    with start_interruptible(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        process.stdout.readline()
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=20)
    assert (process.returncode, err) == (128 + signal.SIGINT, "crfnet: interrupted\n")


@pytest.mark.skipif(sys.platform == "win32", reason="needs a shell")
@pytest.mark.parametrize("closed", [">&-", "2>&-", "2>/dev/full"])
def test_works_without_anywhere_to_print_to(look, tmp_path, closed):
    if "full" in closed and not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    for path, code in ((look / "plate.spi1d", 0), (tmp_path / "none.spi1d", BAD_INPUT)):
        assert subprocess.run(f"'{CRFNET}' info '{path}' {closed}", shell=True, check=False).returncode == code


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize(
    "command",
    [
        *("--version >/dev/full", "--help >/dev/full", "camera list >/dev/full", "info LUT --json >&-"),
        "camera show 'Canon EOS 20D' --json >FILE",  # of which a page fits
    ],
)
def test_a_document_that_nothing_takes_whole_is_an_error(look, tmp_path, command, unbuffered):
    command = command.replace("LUT", f"'{look / 'plate.spi1d'}'").replace("FILE", f"'{tmp_path / 'a.json'}'")
    environment = os.environ | {"PYTHONUNBUFFERED": unbuffered}
    done = ran(f"ulimit -f 8; '{CRFNET}' {command}", shell=True, env=environment)
    assert (done.returncode, done.stderr.count("\n")) == (BAD_INPUT, 1)


def test_a_json_document_is_ascii_whatever_the_encoding_of_the_output(look, tmp_path):
    shutil.copy(look / "plate.spi1d", tmp_path / "\N{LATIN SMALL LETTER U WITH DIAERESIS}.spi1d")
    environment = os.environ | {"PYTHONIOENCODING": "cp437" if os.name == "nt" else "ascii"}
    command = [CRFNET, "info", *tmp_path.iterdir(), "--json"]
    done = subprocess.run(command, capture_output=True, check=True, env=environment)
    assert json.loads(done.stdout.decode("ascii"))["file"].endswith("\N{LATIN SMALL LETTER U WITH DIAERESIS}.spi1d")


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
def test_a_killed_estimate_leaves_no_files_and_can_be_run_again(look, arguments, tmp_path):
    with start_interruptible([sys.executable, "-c", WAITING, *arguments], stdout=subprocess.PIPE, text=True) as process:
        process.stdout.readline()
        process.kill()
    assert all(path.name.startswith(".crfnet-") for path in (tmp_path / "out").iterdir())
    subprocess.run([CRFNET, *arguments], capture_output=True, check=True)
    assert listed(tmp_path / "out") == listed(look)


def test_variables_for_other_programs_do_not_matter(look, arguments, tmp_path):
    """A backend that matplotlib does not know, and what a studio hides of its configs."""
    variables = {"MPLBACKEND": "nonsense", "OCIO_ACTIVE_VIEWS": "ACES", "OCIO_INACTIVE_COLORSPACES": "ACES"}
    done = ran(CRFNET, *arguments, "--depth", "float", env=os.environ | variables)
    assert (done.returncode, done.stderr) == (0, "")
    assert tree(tmp_path / "out") == tree(look)


def test_an_estimate_gives_no_warning_of_python_and_leaves_the_home_empty(arguments, tmp_path):
    """matplotlib would write a list of fonts there; what is not closed is a ResourceWarning."""
    (tmp_path / "home").mkdir()
    names = ("MPLCONFIGDIR", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME")
    environment = {name: value for name, value in os.environ.items() if name not in names}
    environment["HOME"] = str(tmp_path / "home")
    done = ran(sys.executable, "-W", "error", "-m", "crfnet", *arguments, env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    assert listed(tmp_path / "home") == []
    assert "plate_sheet.png" in listed(tmp_path / "out")


#: Run a command with an empty folder for devices, and therefore without the shared memory /dev/shm.
WITHOUT_DEVICES = ["unshare", "-rm", "sh", "-c", 'mount -t tmpfs none /dev && exec "$@"', "sh"]


@pytest.mark.skipif(sys.platform != "linux", reason="needs namespaces")
@pytest.mark.parametrize("command", ["estimate", "linearize"])
def test_works_without_shared_memory(photographs, look, fixed_model, tmp_path, command):
    """Processes of a pool cannot work without it."""
    if shutil.which("unshare") is None or subprocess.run([*WITHOUT_DEVICES, "true"], check=False).returncode:
        pytest.skip("namespaces are not allowed here")
    model = ("--model", fixed_model, "--no-sheet", "--no-linear")
    options = model if command == "estimate" else ("--lut", look / "plate.spi1d")
    arguments = [command, photographs, "--each", "--workers", "2", "--out", tmp_path / "out", *options]
    done = ran(*WITHOUT_DEVICES, CRFNET, *arguments)
    assert (done.returncode, done.stderr) == (0, "")
    assert len(list((tmp_path / "out").rglob("*.exr" if command == "linearize" else "*.spi1d"))) == 3


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX permissions")
def test_the_list_of_fonts_lasts_in_a_folder_that_nobody_else_may_enter(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    folder = Path(printing._font_folder())
    assert (printing._font_folder(), folder.stat().st_mode & 0o777) == (str(folder), 0o700)
    folder.chmod(0o777)
    assert printing._font_folder() != str(folder)
