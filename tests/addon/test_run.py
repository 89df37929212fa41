"""A job from its plate to what was found, with the fixed model: the API's estimate, and no step done twice."""

import dataclasses
import shutil

import numpy as np
import pytest

from blender_addon.work import frame_files
from blender_addon.work import run as run_module
from blender_addon.work.errors import CancelledError
from blender_addon.work.job import Anchor, ApplyMode
from blender_addon.work.run import run
from crfnet.errors import LutError, PlateError
from crfnet.pipeline import estimates
from crfnet_core.colorimetry import DISPLAY_P3, REC709
from tests.helpers.color_profiles import matrix_profile, write_tagged
from tests.helpers.images import write_image
from tests.helpers.refusals import refused


@pytest.fixture
def calls(monkeypatch):
    """Count the calls of functions of a module: calls(module, name) -> a list that grows."""

    def count(module, name):
        made, function = [], getattr(module, name)
        monkeypatch.setattr(module, name, lambda *args, **options: made.append(args) or function(*args, **options))
        return made

    return count


def cancel(_done, _total):
    raise CancelledError("Cancelled")


def test_nodes_need_no_lut_and_no_file(make_job, calls, tmp_path):
    luts = calls(run_module, "response_lut")
    completed = run(make_job(mode=ApplyMode.NODES))
    assert (completed.files, completed.frames, luts) == (None, (), [])
    assert not (tmp_path / "out").exists()


def test_a_bake_looks_for_its_frames_once_and_builds_one_lut(make_job, calls, sequence_file):
    scans, luts = calls(frame_files, "pattern_frames"), calls(run_module, "response_lut")
    completed = run(make_job(sequence_file, is_sequence=True))
    assert (len(scans), len(luts)) == (1, 1)
    assert completed.frames == (1, 2, 3, 5, 6, 7, 8, 9)
    assert len(completed.files.files) == 8


def test_a_stored_estimate_is_used_as_it_is(make_job, sequence_file, estimate, monkeypatch):
    stored = estimate(sequence_file)
    monkeypatch.setattr(run_module, "estimate_plate", None)
    shutil.rmtree(sequence_file.parent)
    completed = run(make_job(sequence_file, is_sequence=True, mode=ApplyMode.EXPORT, stored=stored))
    assert completed.estimate is stored
    assert completed.frames == ()
    assert completed.files.config.name == "config.ocio"


def test_its_primaries_are_those_of_the_file_or_those_that_are_stored(make_job, tmp_path, codes, estimate, monkeypatch):
    monkeypatch.setattr(run_module, "estimate_plate", None)
    path = write_tagged(tmp_path / "p3.png", codes, matrix_profile(DISPLAY_P3))
    stored = estimate(path)
    job = make_job(path, mode=ApplyMode.EXPORT, stored=stored, overwrite=True)
    assert run(job).primaries == DISPLAY_P3
    path.unlink()
    assert run(job).primaries == REC709
    kept = dataclasses.replace(job, estimation=dataclasses.replace(job.estimation, primaries=DISPLAY_P3))
    assert run(kept).primaries == DISPLAY_P3


def test_a_gray_anchor_becomes_018(make_job):
    completed = run(make_job(mode=ApplyMode.NODES, anchor=Anchor.GRAY, gray=0.4, stops=1))
    assert completed.estimate.curve.inverse(0.4) * 2 ** (completed.stops - 1) == pytest.approx(0.18)


def test_a_gray_that_is_black_is_told_and_the_estimate_kept(make_job, plate_file, estimate):
    completed = run(make_job(mode=ApplyMode.NODES, anchor=Anchor.GRAY, gray=0.0))
    assert (completed.problem.code, completed.is_applied) == ("gray_is_black", False)
    assert completed.estimate.uncertainty == estimate(plate_file).uncertainty
    with refused(LutError, "gray_is_black"):
        run(make_job(mode=ApplyMode.NODES, anchor=Anchor.GRAY, gray=0.0, stored=completed.estimate))


@pytest.mark.parametrize("mode", [ApplyMode.BAKE, ApplyMode.EXPORT])
def test_existing_files_are_told_before_the_estimate(make_job, calls, mode):
    run(make_job(mode=mode))
    loads = calls(estimates, "load_network")
    with refused(PlateError, "file_exists" if mode is ApplyMode.BAKE else "files_exist"):
        run(make_job(mode=mode))
    assert loads == []
    assert run(make_job(mode=mode, overwrite=True)).files is not None


def test_a_doubtful_estimate_is_one_with_warnings(make_job, tmp_path):
    assert not run(make_job(mode=ApplyMode.NODES)).is_doubtful
    gray = write_image(tmp_path / "gray.png", np.tile(np.arange(256, dtype=np.uint8)[None, :, None], (256, 1, 1)))
    completed = run(make_job(gray, mode=ApplyMode.NODES))
    assert completed.is_doubtful
    assert [warning.code for warning in completed.estimate.warnings] == ["gray"]


def test_a_cancelled_job_ends_before_the_network_is_loaded(make_job, calls):
    loads = calls(estimates, "load_network")
    with pytest.raises(CancelledError):
        run(make_job(), cancel)
    assert loads == []


def test_a_missing_plate_is_told(make_job, plate_file):
    job = make_job()
    plate_file.unlink()
    with refused(PlateError, "no_such_plate"):
        run(job)
