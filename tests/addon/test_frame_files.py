"""The frames of a plate as files, with a program in the place of the other Blender."""

import dataclasses
import sys
import tempfile

import numpy as np
import pytest

from blender_addon.work.errors import AddonError, CancelledError
from blender_addon.work.frame_files import frame_reader, frames_of, sample, sampled_files
from blender_addon.work.job import ApplyMode, BlenderDecoder
from blender_addon.work.run import run
from crfnet_core.photograph.image_io import read_codes
from tests.helpers.images import read_image, write_image

#: Does as `scene.decode_frames` is asked to, with files that lie beside the movie.
DECODER = """
import json, os, pathlib, shutil, sys
for line in sys.stdin:
    request = json.loads(line)
    if request["frame"] == 13:
        sys.exit("no such frame")
    source = pathlib.Path(request["file"])
    if source.suffix == ".mov":
        source = source.with_name(f"{request['frame']:04d}.png")
    if "OCIO" in os.environ or not os.environ["BLENDER_USER_RESOURCES"]:
        sys.exit("the user's config")
    part = pathlib.Path(request["target"]).with_suffix(".part")
    shutil.copy(source, part)
    part.replace(request["target"])
"""


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """The folder for temporary files, which is empty."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


@pytest.fixture
def movie_job(make_job, tmp_path, codes):
    """Return the job of a movie of so many frames."""
    (tmp_path / "decoder.py").write_text(DECODER)
    command = (sys.executable, str(tmp_path / "decoder.py"))
    for number in range(1, 13):
        write_image(tmp_path / f"{number:04d}.png", np.roll(codes, number, axis=0))
    (tmp_path / "clip.mov").write_bytes(b"a movie")

    def make(frames=12, command=command, **choices):
        job = make_job(tmp_path / "clip.mov", **choices)
        plate = dataclasses.replace(
            job.plate, decoder=BlenderDecoder(command=command, frame_count=frames), has_metadata=False
        )
        return dataclasses.replace(job, plate=plate)

    return make


def test_a_file_of_its_own_is_read_where_it_is(make_job, temporary):
    plate = make_job().plate
    with frame_reader(plate) as read:
        assert read(frames_of(plate), None).paths == (plate.file,)
        assert list(temporary.iterdir()) == []


def test_the_content_of_a_packed_file_and_code_values_are_written_as_they_are(make_job, temporary, codes):
    plate = make_job().plate
    for content in (plate.file.read_bytes(), codes, np.dstack([codes, codes[..., :1]])):
        packed = dataclasses.replace(plate, content=content)
        with frame_reader(packed) as read:
            (path,) = read(frames_of(packed), None).paths
            assert (path.name, path.parent.parent) == ("plate.png", temporary)
            written = read_codes(path)
            np.testing.assert_array_equal(written.codes, codes)
            assert (written.alpha is not None) == (np.shape(content)[2:] == (4,))
        assert list(temporary.iterdir()) == []


def test_no_room_for_a_temporary_file_is_one_sentence(make_job, tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "none"))
    plate = dataclasses.replace(make_job().plate, content=b"packed")
    with pytest.raises(AddonError, match="no temporary file can be written"), frame_reader(plate):
        pass


def test_eight_frames_are_spread_over_a_movie(movie_job):
    chosen = sample(frames_of(movie_job(frames=800).plate))
    assert chosen.numbers == (1, 115, 229, 343, 458, 572, 686, 800)
    assert chosen.paths[1].name == "clip.0115.png"


def test_a_single_file_has_no_frame_numbers(make_job):
    assert sample(frames_of(make_job().plate)).numbers == ()


def test_frames_of_a_sequence_keep_their_numbers(make_job, sequence_file):
    assert sample(frames_of(make_job(sequence_file, is_sequence=True).plate)).numbers == (1, 2, 3, 5, 6, 7, 8, 9)


def test_a_movie_is_estimated_from_decoded_frames(movie_job, temporary, monkeypatch, tmp_path):
    monkeypatch.setenv("OCIO", "a studio's config")
    steps = []
    completed = run(movie_job(mode=ApplyMode.NODES), lambda done, total: steps.append(done / total))
    assert completed.estimate.photos[::7] == ("clip.0001.png", "clip.0012.png")
    assert completed.frames == tuple(range(1, 13))
    assert steps == sorted(steps)
    assert steps[-1] == 1
    assert list(temporary.iterdir()) == []


def test_a_movie_is_baked_in_parts(movie_job, temporary, tmp_path, codes):
    steps = []
    job = movie_job()
    completed = run(job, lambda done, total: steps.append((done, total)))
    assert [path.name for path in completed.files.files] == [f"clip_linear.{n:04d}.exr" for n in range(1, 13)]
    assert completed.files.is_sequence
    for number in (1, 9, 12):
        expected = completed.estimate.curve.inverse(np.roll(codes, number, axis=0) / 255)
        assert np.abs(read_image(completed.files.files[number - 1]) - expected).max() < 1e-6
    assert steps[-1] == (12, 12)
    assert list(temporary.iterdir()) == []


def test_a_frame_that_cannot_be_decoded_takes_the_others_back(movie_job, temporary, tmp_path):
    stored = run(movie_job(mode=ApplyMode.NODES)).estimate
    with pytest.raises(AddonError, match=r"^clip\.mov, frame 13: Blender cannot decode it \(no such frame\)"):
        run(movie_job(frames=14, stored=stored))
    assert not (tmp_path / "out").exists()
    assert list(temporary.iterdir()) == []


def test_existing_files_are_told_before_a_frame_is_decoded(movie_job, tmp_path):
    stored = run(movie_job(mode=ApplyMode.NODES)).estimate
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "clip_linear.0012.exr").write_bytes(b"finished")
    with pytest.raises(AddonError, match="exists already"):
        run(movie_job(stored=stored))
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["clip_linear.0012.exr"]


def test_waiting_for_a_frame_can_be_cancelled(movie_job, temporary):
    def cancel(_done, _total):
        raise CancelledError("Cancelled")

    plate = movie_job(command=(sys.executable, "-c", "import time; time.sleep(60)")).plate
    with frame_reader(plate) as read:
        process = read.__self__._process
        with pytest.raises(CancelledError):
            read(frames_of(plate), cancel)
        assert process.poll() is None
    assert process.poll() is not None
    assert list(temporary.iterdir()) == []


def test_a_blender_that_cannot_be_started_is_one_sentence(movie_job, tmp_path):
    with pytest.raises(AddonError, match=r"^clip: no second Blender can be started to decode it"):
        run(movie_job(command=(str(tmp_path / "none"),)))


def test_files_of_several_plates_are_there_together(movie_job, make_job, temporary, codes):
    movie, own = movie_job().plate, make_job().plate
    painted = dataclasses.replace(own, content=codes)
    steps = []
    plates = [(plate, frames_of(plate)) for plate in (own, movie, painted)]
    with sampled_files(plates, lambda done, total: steps.append((done, total))) as files:
        assert files[0].paths == (own.file,)
        assert [len(frames.paths) for frames in files] == [1, 8, 1]
        assert all(path.is_file() for frames in files for path in frames.paths)
    assert steps == sorted(steps)
    assert (steps[0], steps[-1][1]) == ((1, 10), 10)
    assert list(temporary.iterdir()) == []
