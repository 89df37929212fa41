"""`crfnet estimate --each`: many photographs, one response each."""

import json
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from crfnet.cli.arguments.parts import BAD_INPUT
from crfnet.defaults import ESTIMATES
from crfnet.pipeline import each
from tests.helpers.folders import listed, tree
from tests.helpers.images import write_image
from tests.helpers.processes import start_interruptible

QUICK = ("--each", "--no-sheet", "--no-linear", "--workers", "1")


def manifest_lines(tmp_path):
    settings, *records = map(json.loads, (tmp_path / "out" / ESTIMATES).read_text().splitlines())
    return settings["settings"], records


def test_a_folder_is_searched_and_its_subfolders_are_kept(estimate, photographs, tmp_path):
    done = estimate(photographs, *QUICK)
    assert (done.code, done.err) == (0, "")
    assert listed(tmp_path / "out") == sorted(
        [f"{stem}{suffix}" for stem in "ab" for suffix in (".spi1d", ".cube", ".clf", ".json")]
        + ["config.ocio", "day 2", ESTIMATES]
    )
    assert listed(tmp_path / "out" / "day 2") == ["a.clf", "a.cube", "a.json", "a.spi1d", "config.ocio"]


def test_the_manifest_says_what_the_documents_say(estimate, photographs, tmp_path):
    estimate(photographs, *QUICK)
    _, records = manifest_lines(tmp_path)
    assert [record["photograph"] for record in records] == [
        str(photographs / name) for name in ("a.jpg", "b.JPG", "day 2/a.jpg")
    ]
    for record in records:
        stem = record["photograph"].rpartition("/")[2].partition(".")[0]
        document = json.loads((tmp_path / "out" / record["folder"] / f"{stem}.json").read_text())
        for name in ("weights", "verdict", "uncertainty", "shape_uncertainty_stops", "warnings"):
            assert record[name] == document[name]
        assert record["error"] == ""


def test_the_manifest_keeps_warnings(estimate, photographs, codes, tmp_path):
    write_image(photographs / "gray.png", codes[..., :1].repeat(3, axis=2))
    for _ in range(2):  # and so they are read again
        estimate(photographs, *QUICK)
        _, records = manifest_lines(tmp_path)
        warnings = {Path(record["photograph"]).name: record["warnings"] for record in records}
        assert ["gray photograph" in " ".join(warnings[name]) for name in ("gray.png", "b.JPG")] == [True, False]


def test_processes_write_the_same_bytes_as_one(estimate, crfnet, fixed_model, photographs, tmp_path):
    estimate(photographs, *QUICK)
    arguments = (photographs, "--out", tmp_path / "two", "--model", fixed_model, *QUICK[:-1], "2")
    assert crfnet("estimate", *arguments).code == 0
    assert tree(tmp_path / "two") == tree(tmp_path / "out")


def test_a_bad_photograph_does_not_stop_the_others(estimate, photographs, tmp_path):
    (photographs / "bad.jpg").write_bytes(b"no photograph")
    done = estimate(photographs, *QUICK)
    assert done.code == BAD_INPUT
    assert "1 of 4 photographs failed and the others are written; the first: " in done.err
    assert done.err.count("\n") == 1
    assert sum(", expected error " in line for line in done.out.splitlines()) == 3
    _, records = manifest_lines(tmp_path)
    assert [bool(record["error"]) for record in records] == [False, False, True, False]
    assert "CRF bad" not in (tmp_path / "out" / "config.ocio").read_text()


def test_only_files_that_were_written_are_named(estimate, photographs):
    for name in ("a.jpg", "b.JPG"):
        (photographs / name).write_bytes(b"no photograph")
    bad = (photographs / "a.jpg", photographs / "b.JPG")
    assert "a.spi1d" not in estimate(*bad, *QUICK).out
    shutil.copy(photographs / "day 2" / "a.jpg", photographs / "b.JPG")
    out = estimate(*bad, *QUICK).out
    assert ("a.spi1d" in out, "  b.spi1d, b.cube, b.clf" in out) == (False, True)


def test_a_second_run_does_only_what_is_left(estimate, photographs, tmp_path, monkeypatch):
    (photographs / "bad.jpg").write_bytes(b"no photograph")
    estimate(photographs, *QUICK)
    before = tree(tmp_path / "out")
    shutil.copy(photographs / "a.jpg", photographs / "bad.jpg")
    shutil.copy(photographs / "a.jpg", photographs / "c.jpg")
    worked_on = []
    estimate_one = each.estimate_one
    monkeypatch.setattr(each, "estimate_one", lambda task: (worked_on.append(task.photo.name), estimate_one(task))[1])
    assert estimate(photographs, *QUICK).code == 0
    assert sorted(worked_on) == ["bad.jpg", "c.jpg"]
    after = tree(tmp_path / "out")
    assert {name: after[name] for name in before if name.endswith((".spi1d", ".json"))} == {
        name: content for name, content in before.items() if name.endswith((".spi1d", ".json"))
    }
    config = (tmp_path / "out" / "config.ocio").read_text()
    assert all(f"name: CRF {stem}\n" in config for stem in ("a", "b", "bad", "c"))


def test_of_one_photograph_that_failed_no_others_are_said_to_be_written(estimate, tmp_path):
    (tmp_path / "bad.jpg").write_text("no photograph")
    done = estimate(tmp_path / "bad.jpg", *QUICK)
    assert done.err.startswith(f"crfnet: error: 1 of 1 photographs failed; the first: {tmp_path / 'bad.jpg'}: is no")


def test_other_settings_are_refused(estimate, photographs, tmp_path):
    estimate(photographs, *QUICK)
    before = tree(tmp_path / "out")
    done = estimate(photographs, *QUICK, "--prior", "any")
    assert done.code == BAD_INPUT
    assert "was begun with another --prior (camera);" in done.err
    done = estimate(photographs, *QUICK, "--taken-with", "phone")
    assert "was begun with another --taken-with (none);" in done.err
    for options, words in (
        (("--exposure", "gray"), "with another --exposure (0.0)"),
        (("--length", "256"), "with another --length (4081)"),
        (("--ignore-metadata",), "without --ignore-metadata"),
        (("--forward",), "without --forward"),
    ):
        assert f"was begun {words}; give the same" in estimate(photographs, *QUICK, *options).err
    assert "was begun with --no-linear; give" in estimate(photographs, "--each", "--no-sheet", "--workers", "1").err
    assert tree(tmp_path / "out") == before
    assert estimate(photographs, *QUICK, "--prior", "any", "--overwrite").code == 0
    assert manifest_lines(tmp_path)[0]["prior"] == "any"


def test_files_of_others_stay(estimate, photographs, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "a.cube").write_text("mine")
    done = estimate(photographs, *QUICK)
    assert done.code == BAD_INPUT
    assert "a.cube: exists already" in done.err
    assert (tmp_path / "out" / "a.cube").read_text() == "mine"
    assert "a.spi1d" not in listed(tmp_path / "out")


def test_a_foreign_config_stays(estimate, photographs, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "config.ocio").write_text("mine")
    done = estimate(photographs, *QUICK)
    assert done.code == BAD_INPUT
    assert "config.ocio" in done.err
    assert tree(tmp_path / "out") == {"config.ocio": b"mine"}


def test_what_is_no_manifest_is_refused(estimate, photographs, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / ESTIMATES).write_text("mine\n")
    done = estimate(photographs, *QUICK)
    assert done.code == BAD_INPUT
    assert "is no manifest" in done.err
    assert tree(tmp_path / "out") == {ESTIMATES: b"mine\n"}


@pytest.mark.parametrize(
    "change",
    [
        {"exposure": 10**400},
        {"exposure": float("inf")},
        {"exposure": "much"},
        {"primaries": {"name": "mine", "red": [10**400, 0], "green": [0, 1], "blue": [0, 0]}},
        {"primaries": {"name": "mine", "red": ["a", "b"], "green": [0, 1], "blue": [0, 0]}},
        {
            "primaries": {
                "name": "mine",
                "red": [0.6, 0.3],
                "green": [0.6, 0.3],
                "blue": [0.6, 0.3],
                "white": [0.3, 0.3],
            }
        },
        {"primaries": {"name": "mine", "red": [0.6, 0.3], "green": [0.3, 0.6], "blue": [0.1, 0.1], "white": [0.3, 0]}},
        {"primaries": {"name": "mine", "red": [0.6], "green": [0.3, 0.6], "blue": [0.1, 0.1], "white": [0.3, 0.3]}},
        {"photograph": 1},
        {"folder": "../elsewhere"},
        {"folder": "/elsewhere"},
        {"linear": "../elsewhere/a.exr"},
    ],
)
def test_a_damaged_manifest_is_refused_in_one_line(estimate, photographs, tmp_path, change):
    estimate(photographs / "a.jpg", *QUICK)
    (settings, record), path = (tmp_path / "out" / ESTIMATES).read_text().splitlines(), tmp_path / "out" / ESTIMATES
    path.write_text(f"{settings}\n{json.dumps(json.loads(record) | change)}\n")
    before = tree(tmp_path / "out")
    done = estimate(photographs / "a.jpg", *QUICK)
    assert done.code == BAD_INPUT
    assert done.err == f"crfnet: error: {path}: is no manifest; choose another folder, or add --overwrite\n"
    assert tree(tmp_path / "out") == before


@pytest.mark.parametrize("gray", ["x", "x\ny", [0.18], {}, pytest.param(10**400, id="huge"), True])
def test_damaged_settings_of_a_manifest_are_refused_in_one_line(estimate, photographs, tmp_path, gray):
    estimate(photographs / "a.jpg", *QUICK)
    path = tmp_path / "out" / ESTIMATES
    settings, record = path.read_text().splitlines()
    path.write_text(json.dumps({"settings": json.loads(settings)["settings"] | {"gray": gray}}) + f"\n{record}\n")
    done = estimate(photographs / "a.jpg", *QUICK)
    assert (done.code, done.err.count("\n")) == (BAD_INPUT, 1)
    assert f"{path}: was begun with another --exposure (gray=" in done.err


@pytest.mark.parametrize("text", ["[]", '{"settings": 1}', '{"settings": {}}\n[]', "[" * 200000])
def test_what_is_another_json_is_no_manifest(estimate, photographs, tmp_path, text):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / ESTIMATES).write_text(f"{text}\n")
    done = estimate(photographs, *QUICK)
    assert (done.code, "is no manifest" in done.err, done.err.count("\n")) == (BAD_INPUT, True, 1)


def test_a_lut_that_was_damaged_since_is_named_and_estimated_again(estimate, photographs, tmp_path):
    estimate(photographs, *QUICK)
    (tmp_path / "out" / "a.spi1d").write_text("no LUT")
    shutil.copy(photographs / "a.jpg", photographs / "c.jpg")
    done = estimate(photographs, *QUICK)
    assert done.code == BAD_INPUT
    assert "a.spi1d: " in done.err
    config = tmp_path / "out" / "config.ocio"
    assert [f"name: CRF {stem}\n" in config.read_text() for stem in ("a", "b", "c")] == [False, True, True]
    assert estimate(photographs, *QUICK).code == 0
    assert "name: CRF a\n" in config.read_text()


def test_a_crowded_folder_gets_no_config(estimate, photographs, tmp_path, monkeypatch):
    monkeypatch.setattr(each, "MAX_COLOR_SPACES", 1)
    done = estimate(photographs, *QUICK)
    assert done.code == 0
    assert "config.ocio" not in done.out
    assert "config.ocio" not in listed(tmp_path / "out")
    assert "config.ocio" in listed(tmp_path / "out" / "day 2")


def test_a_folder_without_photographs_is_refused(estimate, tmp_path):
    (tmp_path / "empty").mkdir()
    done = estimate(tmp_path / "empty", "--each")
    assert done.code == BAD_INPUT
    assert "holds no photograph" in done.err


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
def test_a_killed_run_is_continued(photographs, fixed_model, tmp_path):
    code = (
        "import sys, time, crfnet.cli.main, crfnet.pipeline.manifest as m;"
        "add = m.Manifest.add;"
        "m.Manifest.add = lambda self, record: (add(self, record), print('ready', flush=True), time.sleep(60));"
        "sys.exit(crfnet.cli.main.main(sys.argv[1:]))"
    )
    arguments = ["estimate", photographs, "--out", tmp_path / "out", "--model", fixed_model, *QUICK]
    with start_interruptible([sys.executable, "-c", code, *arguments], stdout=subprocess.PIPE) as process:
        process.stdout.readline()
        process.send_signal(signal.SIGKILL)
    assert len(manifest_lines(tmp_path)[1]) == 1
    subprocess.run([sys.executable, "-m", "crfnet.cli.main", *arguments], capture_output=True, check=True)
    assert len(manifest_lines(tmp_path)[1]) == 3
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
    distributed = pytest.importorskip("distributed", reason="Dask is not installed: pip install 'crfnet[cluster]'")
    for number in range(3):
        shutil.copy(photographs / "a.jpg", photographs / f"more {number}.jpg")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        arguments = ["estimate", photographs, "--out", tmp_path / "out", "--model", fixed_model, *QUICK[:-2]]
        command = [sys.executable, "-m", "crfnet.cli.main", *arguments, "--scheduler", cluster.scheduler_address]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            kill_a_busy_worker(distributed, cluster)
            _, err = process.communicate(timeout=100)
    assert (process.returncode, err) == (0, "")
    assert [record["error"] for record in manifest_lines(tmp_path)[1]] == [""] * 6


def test_no_scheduler_is_one_line(estimate, photographs):
    pytest.importorskip("distributed", reason="Dask is not installed: pip install 'crfnet[cluster]'")
    done = estimate(photographs, *QUICK, "--scheduler", "tcp://127.0.0.1:1")
    assert done.code == BAD_INPUT
    assert "no Dask scheduler answers there" in done.err
