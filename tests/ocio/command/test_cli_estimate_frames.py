import json
import shutil

import pytest

from tests.helpers.configs import loaded
from tests.helpers.folders import listed
from tests.helpers.looks import STUDIO, add, space_of
from tests.helpers.movies import write_movie


@pytest.fixture
def estimated(crfnet, fixed_model, tmp_path):
    """Estimate from a name with options, and return the names of the photographs in the document."""

    def names(name, *more):
        options = ("--out", tmp_path / "look", "--model", fixed_model, "--no-sheet", "--no-linear", "--json")
        document = json.loads(crfnet("estimate", *options, name, *more).printed)
        return [photo["name"] for photo in document["estimates"][0]["photographs"]]

    return names


@pytest.fixture
def shot(plate, tmp_path):
    """A sequence of the bundled photograph, frames 1001 to 1012."""
    folder = tmp_path / "shot"
    folder.mkdir()
    for number in range(1001, 1013):
        shutil.copy(plate, folder / f"shot.{number}.jpg")
    return folder


def frames(*numbers):
    return [f"shot.{number}.jpg" for number in numbers]


def test_a_sequence_gives_some_of_its_frames(estimated, shot, tmp_path):
    assert estimated(shot / "shot.%04d.jpg") == frames(1001, 1003, 1004, 1006, 1007, 1009, 1010, 1012)
    assert "shot.1001.spi1d" in listed(tmp_path / "look")


@pytest.mark.parametrize("name", ["shot.####.jpg", ""], ids=["pattern", "folder"])
def test_frames_of_a_sequence_are_chosen(estimated, shot, name):
    assert estimated(shot / name, "--frames", "1002-1010x4") == frames(1002, 1006, 1010)


@pytest.mark.parametrize(
    "names", [["garden_%03d.jpg"], ["garden_001.jpg", "garden_002.jpg"]], ids=["sequence", "two shots"]
)
def test_the_config_knows_all_frames_of_a_sequence_but_no_other_shots(estimated, shot, tmp_path, names):
    for number, path in enumerate(sorted(shot.iterdir()), 1):
        path.rename(shot / f"garden_{number:03d}.jpg")
    estimated(*(shot / name for name in names))
    made, derived = tmp_path / "look" / "config.ocio", tmp_path / "show"
    configs = [loaded(path) for path in (made, add(STUDIO, derived, made.parent).path)]
    known = [space_of(config, "garden_003.jpg") == "CRF garden_001" for config in configs]
    assert known == [len(names) == 1] * 2


def test_frames_of_a_movie_are_chosen(estimated, tmp_path):
    movie = write_movie(tmp_path / "clip.mp4", 24, size=(320, 240), options={"g": "1"})
    found = estimated(movie, "--frames", "10-12")
    assert set() < set(found) <= {f"clip.mp4 frame {number}" for number in (10, 11, 12)}
