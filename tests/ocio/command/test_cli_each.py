import dataclasses
import json
import shutil
import signal
import socket
import subprocess
import sys
import time
from concurrent.futures import Future
from contextlib import nullcontext
from types import SimpleNamespace
from unittest.mock import Mock

import pytest

from crfnet.cli.arguments.parts import NOT_TRUSTED
from crfnet.defaults import ESTIMATES
from crfnet.errors import PlateError
from crfnet.pipeline import batch, each, run, workers
from crfnet.pipeline.records import PhotographRecord, RecordFile
from tests.helpers.folders import listed, tree, written
from tests.helpers.footage import log_picture, write_picture
from tests.helpers.processes import start_interruptible
from tests.helpers.records import plates_in, records_in
from tests.helpers.refusals import refusal_of, refused

QUICK = ("--each", "--no-sheet", "--no-linear", "--workers", "1")


def without_records(files):
    return {name: content for name, content in files.items() if name != ESTIMATES}


def test_a_folder_is_searched_and_its_subfolders_are_kept(estimate, photographs, tmp_path):
    assert estimate(photographs, *QUICK).printed
    assert listed(tmp_path / "out") == sorted(
        [f"{stem}{suffix}" for stem in "ab" for suffix in (".spi1d", ".cube", ".clf", ".json")]
        + ["config.ocio", "day 2", ESTIMATES]
    )
    assert listed(tmp_path / "out" / "day 2") == ["a.clf", "a.cube", "a.json", "a.spi1d", "config.ocio"]


def test_the_records_agree_with_the_documents_and_name_the_lut(estimate, photographs, tmp_path):
    estimate(photographs, *QUICK)
    names = ("a.jpg", "b.JPG", "day 2/a.jpg")
    records = records_in(tmp_path / "out")
    assert [record["photograph"] for record in records] == [str(photographs / name) for name in names]
    assert [record["lut"] for record in records] == ["a.spi1d", "b.spi1d", "day 2/a.spi1d"]
    for record in records:
        stem = record["photograph"].rpartition("/")[2].partition(".")[0]
        document = json.loads((tmp_path / "out" / record["folder"] / f"{stem}.json").read_text())
        for name in ("weights", "verdict", "uncertainty", "shape_uncertainty_stops", "warnings"):
            assert record[name] == document[name]
        assert record["error"] == ""


def test_processes_write_the_same_bytes_as_one(estimate, crfnet, fixed_model, photographs, tmp_path):
    estimate(photographs, *QUICK)
    arguments = (photographs, "--out", tmp_path / "two", "--model", fixed_model, *QUICK[:-1], "2")
    assert crfnet("estimate", *arguments).code == 0
    assert without_records(tree(tmp_path / "two")) == without_records(tree(tmp_path / "out"))


def test_a_bad_photograph_stops_no_other_and_a_second_run_does_only_what_is_left(
    estimate, photographs, tmp_path, monkeypatch
):
    (photographs / "bad.jpg").write_bytes(b"no photograph")
    done = estimate(photographs, *QUICK)
    assert (done.refusal, done.out.count(", expected error ")) == ("photographs_failed", 3)
    assert [bool(record["error"]) for record in records_in(tmp_path / "out")] == [False, False, True, False]
    assert plates_in(tmp_path / "out") == ["a", "b"]
    before = tree(tmp_path / "out")
    shutil.copy(photographs / "a.jpg", photographs / "bad.jpg")
    shutil.copy(photographs / "a.jpg", photographs / "c.jpg")
    worked_on, write_files = [], each.EstimateBatch.done

    def count(batch, task):
        worked_on.append(task.photo.name)
        return write_files(batch, task)

    monkeypatch.setattr(each.EstimateBatch, "done", count)
    assert estimate(photographs, *QUICK).code == 0
    assert sorted(worked_on) == ["bad.jpg", "c.jpg"]
    after = tree(tmp_path / "out")
    assert all(after[name] == before[name] for name in before if name.endswith((".spi1d", ".json")))
    assert plates_in(tmp_path / "out") == ["a", "b", "bad", "c"]


@pytest.mark.parametrize(
    "choice", [("--prior", "any"), ("--taken-with", "phone"), ("--exposure", "gray"), ("--forward",)]
)
def test_other_options_are_refused(estimate, photographs, tmp_path, choice):
    estimate(photographs / "a.jpg", *QUICK)
    before = tree(tmp_path / "out")
    assert estimate(photographs / "a.jpg", *QUICK, *choice).refusal == "other_options"
    assert tree(tmp_path / "out") == before
    assert estimate(photographs / "a.jpg", *QUICK, *choice, "--overwrite").code == 0
    assert estimate(photographs / "a.jpg", *QUICK, *choice).code == 0


def test_two_runs_at_once_lose_no_record(photographs, fixed_model, tmp_path):
    arguments = ["estimate", photographs, "--out", tmp_path / "out", "--model", fixed_model, *QUICK]
    command = [sys.executable, "-m", "crfnet", *map(str, arguments)]
    runs = [subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    errors = [run.communicate(timeout=100)[1] for run in runs]
    assert ([run.returncode for run in runs], errors) == ([0, 0], ["", ""])
    assert [record["error"] for record in records_in(tmp_path / "out")] == [""] * 3
    assert plates_in(tmp_path / "out") == ["a", "b"]


def test_a_run_of_other_options_that_begins_at_the_same_time_replaces_nothing(estimate, photographs, out, monkeypatch):
    assert estimate(photographs, *QUICK).code == 0
    before = without_records(tree(out))
    monkeypatch.setattr(batch, "_check_earlier", lambda *_: None)  # the other run had no record then
    done = estimate(photographs, *QUICK, "--exposure", "1")
    assert (done.refusal, done.out.count("with other options")) == ("photographs_failed", 3)
    assert without_records(tree(out)) == before


def test_strict_ends_with_3_if_any_is_not_to_be_trusted(estimate, photographs):
    assert estimate(photographs, *QUICK, "--strict").code == 0
    write_picture(photographs / "log.png", log_picture("Sony S-Log3"))
    for _ in range(2):
        done = estimate(photographs, *QUICK, "--strict")
        assert (done.code, done.err) == (NOT_TRUSTED, "")
    assert estimate(photographs, *QUICK).code == 0
    assert estimate(photographs / "log.png", "--no-sheet", "--no-linear", "--overwrite", "--strict").code == NOT_TRUSTED


@pytest.mark.parametrize("name", ["a.cube", "config.ocio"])
def test_files_of_others_stay(estimate, photographs, out, name):
    (out / name).write_text("mine")
    assert estimate(photographs, *QUICK).refusal
    assert (out / name).read_text() == "mine"
    assert "a.spi1d" not in listed(out)


@pytest.mark.parametrize("text", ["mine\n", "[]\n", '{"folder": "a"}\n', "[" * 200000 + "\n", "mine", '{"place": "a"}'])
def test_a_file_of_other_lines_is_refused(estimate, photographs, out, text):
    (out / ESTIMATES).write_text(text)
    assert estimate(photographs, *QUICK).refusal == "not_records"
    if not text.endswith("\n"):  # as it may appear during a run
        with refused(PlateError, "not_records"):
            RecordFile(out / ESTIMATES).append(PhotographRecord(photograph="a.jpg", place="a.jpg"))
    assert tree(out) == {ESTIMATES: text.encode()}


def test_a_cut_line_goes_also_where_nothing_is_left_to_do(estimate, photographs, out):
    assert estimate(photographs, *QUICK).code == 0
    whole = (out / ESTIMATES).read_bytes()
    for cut in (whole[:50], bytes(4096), whole[:50] + bytes(50)):  # zeros, after a failure of power
        written(out / ESTIMATES, whole + cut)
        assert estimate(photographs, *QUICK).code == 0
        assert (out / ESTIMATES).read_bytes() == whole


@pytest.mark.parametrize("text", ["", '{"photograph": "a'])
def test_a_link_in_place_of_the_records_is_not_followed(estimate, photographs, out, tmp_path, text):
    (tmp_path / "mine").write_text(text)
    (out / ESTIMATES).symlink_to(tmp_path / "mine")
    assert estimate(photographs, *QUICK).refusal == "not_records"
    with refused(PlateError, "not_written"):
        RecordFile(out / ESTIMATES).append(PhotographRecord(photograph="a.jpg", place="a.jpg"))
    assert (tmp_path / "mine").read_text() == text


@pytest.mark.parametrize(
    "change",
    [
        *({"exposure": exposure} for exposure in (10**400, "much", True)),
        {"primaries": {"name": "mine", "red": [10**400, 0], "green": [0, 1], "blue": [0, 0]}},
        {"primaries": {"name": "mine"} | {key: [0.3, 0.3] for key in ("red", "green", "blue", "white")}},
        *({name: 1} for name in ("photograph", "place")),
        *({"folder": folder} for folder in ("../elsewhere", "/elsewhere")),
        {"linear": "../elsewhere/a.exr"},
    ],
)
def test_a_damaged_record_is_refused_in_one_line(tmp_path, change):
    file = RecordFile(tmp_path / ESTIMATES)
    file.append(PhotographRecord(photograph="a.jpg", place="a.jpg"))
    assert list(file.read()) == ["a.jpg"]
    with file.path.open("a") as lines:
        lines.write(json.dumps(dataclasses.asdict(PhotographRecord(photograph="b.jpg", place="b.jpg")) | change) + "\n")
    assert refusal_of(PlateError, file.read).code == "not_records"


@pytest.mark.parametrize("has_locks", [True, False])
def test_an_error_does_not_hide_the_record_of_another_runs_files(tmp_path, monkeypatch, has_locks):
    if not has_locks:
        monkeypatch.setattr("fcntl.flock", Mock(side_effect=OSError("no locks")))
    file, names = RecordFile(tmp_path / ESTIMATES), {"photograph": "a.jpg", "place": "a.jpg"}
    (lut := tmp_path / "a.spi1d").touch()
    file.append(PhotographRecord(**names, lut="a.spi1d", exposure=-1, weights=(-0.5, 1)))
    file.append(PhotographRecord(**names, error="exists"), files=[lut])
    assert file.read()["a.jpg"].weights == (-0.5, 1)
    lut.unlink()
    file.append(PhotographRecord(**names, error="exists"), files=[lut])
    assert file.read()["a.jpg"].error == "exists"


def test_a_lut_that_was_damaged_since_is_named_and_estimated_again(estimate, photographs, tmp_path):
    estimate(photographs, *QUICK)
    (tmp_path / "out" / "a.spi1d").write_text("no LUT")
    shutil.copy(photographs / "a.jpg", photographs / "c.jpg")
    assert f"{tmp_path / 'out' / 'a.spi1d'}: is damaged; run the same again" in estimate(photographs, *QUICK).err
    assert plates_in(tmp_path / "out") == ["b", "c"]
    assert estimate(photographs, *QUICK).code == 0
    assert plates_in(tmp_path / "out") == ["a", "b", "c"]


def test_a_crowded_folder_gets_no_config(estimate, photographs, tmp_path, monkeypatch):
    monkeypatch.setattr(each, "MAX_COLOR_SPACES", 1)
    assert estimate(photographs, *QUICK).code == 0
    assert "config.ocio" not in listed(tmp_path / "out")
    assert "config.ocio" in listed(tmp_path / "out" / "day 2")


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
def test_a_killed_run_leaves_no_process_and_is_continued(photographs, fixed_model, tmp_path):
    code = (
        "import sys, time, crfnet.cli.main, crfnet.pipeline.records as r;"
        "append = r.RecordFile.append;"
        "r.RecordFile.append = lambda *facts, **_: (append(*facts), print('ready', flush=True), time.sleep(60));"
        "sys.exit(crfnet.cli.main.main(sys.argv[1:]))"
    )
    arguments = ["estimate", photographs, "--out", tmp_path / "out", "--model", fixed_model, *QUICK]
    parallel = [sys.executable, "-c", code, *arguments, "--workers", "2"]
    with start_interruptible(parallel, stdout=subprocess.PIPE) as process:
        process.stdout.readline()
        process.send_signal(signal.SIGKILL)
        process.communicate(timeout=30)  # until the workers, too, have closed it
    assert len(records_in(tmp_path / "out")) == 1
    subprocess.run([sys.executable, "-m", "crfnet.cli.main", *arguments], capture_output=True, check=True)
    assert len(records_in(tmp_path / "out")) == 3
    assert "config.ocio" in listed(tmp_path / "out")


def kill_a_busy_worker(distributed, cluster):
    """Wait until a worker of the cluster has something to do, and kill its process."""
    with distributed.Client(cluster) as client:
        for _ in range(600):
            busy = [address for address, tasks in client.processing().items() if tasks]
            if busy:
                break
            time.sleep(0.1)
    nanny = next(nanny for nanny in cluster.workers.values() if nanny.worker_address == busy[0])
    nanny.process.process.kill()


def test_a_dask_worker_that_dies_loses_nothing(photographs, fixed_model, tmp_path):
    """Workers run in another folder than the command, whose names are relative."""
    distributed = pytest.importorskip("distributed", reason="Dask is not installed: pip install 'crfnet[cluster]'")
    for number in range(3):
        shutil.copy(photographs / "a.jpg", photographs / f"more {number}.jpg")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        arguments = ["estimate", photographs.name, "--out", "out", "--model", fixed_model, *QUICK[:-2]]
        command = [sys.executable, "-m", "crfnet.cli.main", *arguments, "--scheduler", cluster.scheduler_address]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
        with subprocess.Popen(command, **pipes, text=True, cwd=tmp_path) as process:
            kill_a_busy_worker(distributed, cluster)
            _, err = process.communicate(timeout=100)
    assert (process.returncode, err) == (0, "")
    assert [record["error"] for record in records_in(tmp_path / "out")] == [""] * 6
    assert all(record["photograph"].startswith("photographs") for record in records_in(tmp_path / "out"))


@pytest.mark.parametrize(("problem", "code"), [(None, "process_died"), (KeyError("a"), "photographs_failed")])
def test_a_cluster_that_goes_and_a_worker_that_fails_are_one_line(estimate, photographs, monkeypatch, problem, code):
    def submit(*_):
        future = Future()
        if problem is None:
            future.cancel()
            future.set_running_or_notify_cancel()
        else:
            future.set_exception(problem)
        return future

    monkeypatch.setattr(run, "worker_pool", lambda *_, **__: nullcontext(SimpleNamespace(submit=submit)))
    assert estimate(photographs, *QUICK).refusal == code


@pytest.mark.parametrize(
    "address", ["tcp://127.0.0.1:{silent}", "tls://127.0.0.1:{silent}", "ws://127.0.0.1:{silent}", "ucx://x", "x y"]
)
def test_no_scheduler_is_one_line(estimate, photographs, monkeypatch, address):
    """Also of a server that takes the connection and says nothing."""
    pytest.importorskip("distributed", reason="Dask is not installed: pip install 'crfnet[cluster]'")
    monkeypatch.setattr(workers, "SCHEDULER_TIMEOUT", 0.5)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        done = estimate(photographs, *QUICK, "--scheduler", address.format(silent=silent.getsockname()[1]))
    assert done.refusal == "no_scheduler"
