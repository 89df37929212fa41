import json
import os
import shutil

import numpy as np
import pytest

from crfnet.defaults import PLATES
from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import inverse_response_lut
from crfnet_core import ResponseCurve
from crfnet_core.library.library import SHIPPED
from tests.helpers.folders import listed, tree
from tests.helpers.images import read_image
from tests.helpers.records import records_in


@pytest.fixture
def linearize(crfnet, fixed_model, tmp_path):
    """Run `crfnet linearize --each` with the fixed model into tmp_path/out, in one process."""

    def run(*arguments):
        options = ("--out", tmp_path / "out", "--model", fixed_model, "--depth", "float", "--workers", "1")
        return crfnet("linearize", *arguments, "--each", *options)

    return run


def test_a_lut_holds_for_all(linearize, photographs, look, linear, tmp_path):
    assert linearize(photographs, "--lut", look / "plate.spi1d").printed
    assert listed(tmp_path / "out") == ["a.exr", "b.exr", "day 2", PLATES]
    np.testing.assert_array_equal(read_image(tmp_path / "out" / "day 2" / "a.exr"), linear)
    assert [record["linear"] for record in records_in(tmp_path / "out")] == ["a.exr", "b.exr", "day 2/a.exr"]
    assert not any(record["weights"] or record["error"] for record in records_in(tmp_path / "out"))


def test_each_has_its_own_response(linearize, photographs, look, linear, tmp_path):
    assert linearize(photographs).code == 0
    document = json.loads((look / "plate.json").read_text())
    for record in records_in(tmp_path / "out"):
        assert (record["weights"], record["verdict"]) == (document["weights"], document["verdict"])
    np.testing.assert_allclose(read_image(tmp_path / "out" / "a.exr"), linear, rtol=1e-6)


def test_a_camera_holds_for_all(linearize, photographs, tmp_path):
    assert linearize(photographs, "--camera", "Canon EOS 20D").printed
    records = records_in(tmp_path / "out")
    assert len({tuple(record["weights"]) for record in records}) == 1
    assert [record["summary"].partition(":")[0] for record in records] == ["a.jpg", "b.JPG", "a.jpg"]


def test_a_movie_is_told_to_go_by_itself(linearize, plate, look, tmp_path):
    movie = tmp_path / "clip.mp4"
    movie.write_bytes(b"\0\0\0\x18ftypisom" + bytes(64))
    done = linearize(plate, movie, "--lut", look / "plate.spi1d")
    assert (done.refusal, f"{movie}: is a movie" in done.err) == ("photographs_failed", True)


def test_a_finished_file_without_a_record_stays(linearize, photographs, look, tmp_path):
    """As a run leaves it that is killed in between."""
    arguments = (photographs, "--lut", look / "plate.spi1d")
    linearize(*arguments)
    before = (tmp_path / "out" / "a.exr").stat().st_mtime_ns
    (tmp_path / "out" / PLATES).unlink()
    assert linearize(*arguments).code == 0
    assert (tmp_path / "out" / "a.exr").stat().st_mtime_ns == before
    assert len(records_in(tmp_path / "out")) == 3
    (photographs / "a.jpg").unlink()
    assert f"{photographs / 'a.jpg'}: does not exist" in linearize(photographs / "a.jpg", *arguments[1:]).err


def test_a_recorded_file_that_was_cut_since_is_refused(linearize, photographs, look, tmp_path):
    """As a copy that was stopped leaves it."""
    linearize(photographs, "--lut", look / "plate.spi1d")
    os.truncate(tmp_path / "out" / "b.exr", 3000)
    done = linearize(photographs, "--lut", look / "plate.spi1d")
    assert (done.refusal, "1 of 3 photographs failed" in done.err) == ("photographs_failed", True)


def test_a_lut_that_has_changed_is_read_again(linearize, photographs, look, tmp_path):
    """Also by a process that has read it before, as the workers of a cluster have."""
    lut = shutil.copy(look / "plate.spi1d", tmp_path / "lut.spi1d")
    linearize(photographs, "--lut", lut)
    before = read_image(tmp_path / "out" / "a.exr")
    write_lut(lut, inverse_response_lut(ResponseCurve.gamma()), overwrite=True)
    (tmp_path / "out" / "b.exr").unlink()
    files = tree(tmp_path / "out")
    assert linearize(photographs, "--lut", lut).refusal == "other_options"  # else b.exr would differ from a.exr
    assert tree(tmp_path / "out") == files
    assert linearize(photographs, "--lut", lut, "--overwrite").code == 0
    assert np.abs(read_image(tmp_path / "out" / "a.exr") - before).max() > 0.01


@pytest.mark.parametrize("command", ["estimate", "linearize"])
def test_so_is_a_camera_that_has_changed(crfnet, fixed_model, photographs, own_cameras, tmp_path, command):
    own_cameras.mkdir(exist_ok=True)
    options = ("--each", "--camera", "mine", "--workers", "1", "--model", fixed_model, "--out", tmp_path / "out")
    options = (*options, "--no-sheet", "--no-linear") if command == "estimate" else options

    def run_with(camera):
        shutil.copy(SHIPPED / camera, own_cameras / "mine.json")
        return crfnet(command, photographs, *options)

    first, second = sorted(path.name for path in SHIPPED.glob("*.json"))[:2]
    try:
        assert [run_with(first).code, run_with(first).code] == [0, 0]
        done = run_with(second)
    finally:
        (own_cameras / "mine.json").unlink()
    assert done.refusal == "other_options"


@pytest.mark.parametrize("command", ["estimate", "linearize"])
def test_a_photograph_that_has_changed_fails_alone_until_its_files_are_deleted(
    crfnet, fixed_model, photographs, look, tmp_path, command
):
    options = ("--no-sheet", "--no-linear", "--model", fixed_model)
    options = options if command == "estimate" else ("--lut", look / "plate.spi1d")

    def run():
        return crfnet(command, photographs, "--each", "--workers", "1", "--out", tmp_path / "out", *options)

    assert (run().code, run().out.count("left alone")) == (0, 3)
    os.utime(photographs / "a.jpg", (0, 0))  # copied: the content is the same
    with (photographs / "b.JPG").open("ab") as photograph:
        photograph.write(b"another grade")
    before = tree(tmp_path / "out")
    for _ in range(2):
        done = run()
        assert (done.refusal, done.out.count("left alone")) == ("photographs_failed", 2)
        assert f"{photographs / 'b.JPG'}: has changed" in done.out
        assert tree(tmp_path / "out") == before
    for path in (tmp_path / "out").glob("b.*"):
        path.unlink()
    assert (run().code, run().out.count("left alone")) == (0, 3)
