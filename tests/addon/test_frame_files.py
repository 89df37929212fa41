"""The frames of a plate as files."""

import dataclasses
import tempfile

import numpy as np
import pytest

from blender_addon.work.errors import AddonError
from blender_addon.work.frame_files import frame_reader, frames_of
from blender_addon.work.job import ApplyMode
from blender_addon.work.run import run
from crfnet_core.photograph.image_io import read_codes


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """The folder for temporary files, which is empty."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


@pytest.fixture
def movie_job(make_job, tmp_path, codes):
    """Return the job of a movie of 12 frames, of which the seventh is shown."""
    (tmp_path / "clip.mov").write_bytes(b"a movie")

    def make(content=codes, **choices):
        job = make_job(tmp_path / "clip.mov", **choices)
        plate = dataclasses.replace(job.plate, content=content, shown_frame=7, frame_count=12, has_metadata=False)
        return dataclasses.replace(job, plate=plate)

    return make


def test_a_file_of_its_own_is_read_where_it_is(make_job, temporary):
    plate = make_job().plate
    with frame_reader(plate) as read:
        assert read(frames_of(plate)).paths == (plate.file,)
        assert list(temporary.iterdir()) == []


def test_the_content_of_a_packed_file_and_code_values_are_written_as_they_are(make_job, temporary, codes):
    plate = make_job().plate
    for content in (plate.file.read_bytes(), codes, np.dstack([codes, codes[..., :1]])):
        packed = dataclasses.replace(plate, content=content)
        with frame_reader(packed) as read:
            (path,) = read(frames_of(packed)).paths
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


def test_a_movie_is_estimated_from_the_frame_shown(movie_job, temporary):
    completed = run(movie_job(mode=ApplyMode.NODES))
    assert completed.estimate.photos == ("clip.0007.png",)
    assert completed.frames == tuple(range(1, 13))
    assert list(temporary.iterdir()) == []


def test_a_movie_without_code_values_and_a_bake_of_one_are_refused(movie_job, tmp_path):
    with pytest.raises(AddonError, match="movies of more than 8 bits"):
        run(movie_job(content=None, mode=ApplyMode.NODES))
    with pytest.raises(AddonError, match="movies are not baked"):
        run(movie_job(mode=ApplyMode.BAKE))
    assert not (tmp_path / "out").exists()
