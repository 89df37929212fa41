import os
import shutil
import signal
import subprocess
import sys
import threading
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from crfnet.errors import PlateError
from crfnet.luts.lut1d import Lut1D
from crfnet.plates import linear
from crfnet.plates.frame_files import EncodedFrame, FirstFrame
from crfnet_core.photograph.image_io import read_photo
from tests.helpers.folders import listed
from tests.helpers.images import write_image
from tests.helpers.plates import LUT, SMALL, linearize, read_exr, write_sequence
from tests.helpers.processes import start_interruptible
from tests.helpers.refusals import refusal_of, refused

ROOT = Path(__file__).parents[3]

RUN = """
import sys
from crfnet.luts.lut1d import Lut1D
from crfnet.options import PlateOptions
from crfnet.plates.frames import find_frames
from crfnet.plates.linear import linear_targets, linearize_plates
sequence = find_frames(sys.argv[1])
targets = linear_targets(sys.argv[2], sequence)
lut, options = Lut1D([0, 0.2, 1]), PlateOptions(depth="float")
linearize_plates(sequence, targets, lut, options, progress=lambda *_: print(flush=True))
"""


def test_every_frame_of_a_sequence_is_written(tmp_path, out):
    pattern = write_sequence(tmp_path, (1, 2, 4, 7))
    calls = []
    report = linearize(pattern, out / "lin_###.exr", LUT, progress=lambda *call: calls.append(call))
    assert [path.name for path in report.written] == ["lin_001.exr", "lin_002.exr", "lin_004.exr", "lin_007.exr"]
    assert (report.skipped, report.missing) == ((), (3, 5, 6))
    assert calls == [(0, 4), (1, 4), (2, 4), (3, 4), (4, 4)]
    assert listed(out) == [path.name for path in report.written]
    for number, path in zip((1, 2, 4, 7), report.written, strict=True):
        expected = LUT.apply(read_photo(tmp_path / f"plate.{number:04d}.png").pixels).astype(np.float16)
        np.testing.assert_array_equal(read_exr(path)[0], expected)


def test_bad_and_missing_frames_are_named_and_the_others_written(tmp_path, out):
    pattern = write_sequence(tmp_path, (1, 2, 3, 5, 9))
    for path in (tmp_path / "plate.0002.png", tmp_path / "plate.0003.png"):
        os.truncate(path, path.stat().st_size // 2)
    calls, arguments = [], (pattern, out / "a.%d.exr", LUT)
    some = refusal_of(PlateError, linearize, *arguments, progress=lambda *call: calls.append(call))
    facts = some.facts
    assert (some.code, facts["count"], facts["total"], facts["frames"]) == ("frames_failed", 2, 5, "2-3")
    assert (facts["first"].facts["path"], facts["gaps"]) == (tmp_path / "plate.0002.png", "; missing are 4, 6-8")
    assert (listed(out), calls[-1]) == (["a.1.exr", "a.5.exr", "a.9.exr"], (5, 5))
    none = refusal_of(PlateError, linearize, *arguments, frames="2-3")
    assert ["the others are written" in str(problem) for problem in (some, none)] == [True, False]
    write_sequence(tmp_path, (2, 3))
    report = linearize(*arguments, progress=lambda *call: calls.append(call))
    assert (len(report.written), calls[-3:]) == (2, [(3, 5), (4, 5), (5, 5)])


def test_frames_that_another_process_finishes_meanwhile_are_left_alone_or_refused_if_they_differ(tmp_path, out):
    pattern = write_sequence(tmp_path, (1, 2, 3))
    linearize(pattern, tmp_path / "other_####.exr", LUT)
    finished, target = tmp_path / "other_0002.exr", out / "a_0002.exr"

    def appear(*_):
        if not target.exists():
            shutil.copy(finished, target)

    report = linearize(pattern, out / "a_####.exr", LUT, progress=appear)
    assert [path.name for path in report.written] == ["a_0001.exr", "a_0003.exr"]
    assert [path.name for path in report.skipped] == ["a_0002.exr"]
    assert target.read_bytes() == finished.read_bytes()
    target.unlink()
    finished = tmp_path / "other_0003.exr"
    with refused(PlateError, "finished_outdated", path=target, more=""):
        linearize(pattern, out / "a_####.exr", LUT, progress=appear)


def test_a_run_that_replaces_frames_says_when_another_has_replaced_one_of_its_own(tmp_path, out):
    pattern, targets = write_sequence(tmp_path, (1, 2)), out / "a_####.exr"
    linearize(pattern, tmp_path / "other_####.exr", Lut1D([0, 0.1, 1]))

    def replace(done, total):
        if done == total:
            shutil.copy(tmp_path / "other_0001.exr", out / "a_0001.exr")

    with refused(PlateError, "written_meanwhile", path=out / "a_0001.exr"):
        linearize(pattern, targets, LUT, overwrite=True, progress=replace)
    linearize(pattern, targets, LUT, overwrite=True)


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
@pytest.mark.parametrize("stop", [signal.SIGKILL, signal.SIGINT])
def test_an_interrupted_run_leaves_whole_frames_and_is_resumed(tmp_path, out, stop):
    total = 24
    large = np.tile(SMALL[..., :3], (10, 8, 1))
    write_image(tmp_path / "plate.0000.png", large, png__compressionLevel=1)
    for number in range(1, total):
        shutil.copy(tmp_path / "plate.0000.png", tmp_path / f"plate.{number:04d}.png")
    arguments = [sys.executable, "-c", RUN, tmp_path / "plate.%04d.png", out / "a.%d.exr"]
    process = start_interruptible(arguments, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    for _ in range(3):
        assert process.stdout.readline()
    process.send_signal(stop)
    process.stdout.close()
    assert process.wait(timeout=30) != 0
    finished = [path for path in out.iterdir() if not path.name.startswith(".")]
    assert 2 <= len(finished) < total
    if stop == signal.SIGINT:
        assert len(finished) == len(listed(out))
    lut = Lut1D([0, 0.2, 1])
    expected = lut.apply(large / 255).astype(np.float32)
    for path in finished:
        np.testing.assert_array_equal(read_exr(path)[0], expected)
    report = linearize(tmp_path / "plate.%04d.png", out / "a.%d.exr", lut, depth="float")
    assert set(report.skipped) == set(finished)
    assert len(report.written) == total - len(finished)
    np.testing.assert_array_equal(read_exr(report.written[-1])[0], expected)


@pytest.mark.parametrize("workers", [1, 3])
def test_jobs_are_taken_only_when_there_is_room(workers):
    taken, ended, most = [], [], []

    def jobs():
        for number in range(30):
            taken.append(number)
            most.append(len(taken) - len(ended))
            yield number, lambda number=number: ended.append(number)

    list(linear.finished(jobs(), workers, waiting=2))
    assert max(most) <= workers + 2


def test_closing_finishes_what_has_begun_and_drops_the_rest():
    begun, go = [], threading.Event()

    def work():
        begun.append(1)
        go.wait(5)

    jobs = [(0, lambda: None), *((number, work) for number in range(1, 9))]
    with closing(linear.finished(jobs, 1, waiting=4)) as ended:
        assert next(ended)[0] == 0
        go.set()
    assert len(begun) < 8
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("plate")]


def test_of_large_frames_fewer_are_in_memory(monkeypatch):
    monkeypatch.setattr(linear, "cores", lambda: 16)
    sizes = [np.broadcast_to(np.uint8(0), (side, side, 3)) for side in (4000, 8000, 16000)]
    frames = [EncodedFrame(samples, 255, None, None) for samples in sizes]
    assert [linear._workers(FirstFrame(0, Path(), frame)) for frame in frames] == [8, 3, 1]
