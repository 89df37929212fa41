"""The frames from which a response is estimated."""

import numpy as np
import pytest

from crfnet.defaults import FRAMES_ANALYZED
from crfnet.movies.frames import MovieFrames
from crfnet.movies.source import chosen_photos
from tests.helpers.movies import pictures, write_movie

pytest.importorskip("av", reason="needs PyAV: the extra video")

KEYS = {"options": {"g": "6"}}


def chosen(path, frames=None):
    return [number for number, _ in chosen_photos(MovieFrames.find(path, frames))]


def test_frames_are_key_frames_spread_over_the_movie(tmp_path):
    numbers = chosen(write_movie(tmp_path / "a.mp4", 96, **KEYS))
    assert len(numbers) == FRAMES_ANALYZED
    assert [(number - 1) // 12 for number in numbers] == list(range(8)), "one in each eighth"
    assert all(number % 6 == 1 for number in numbers)


def test_frames_are_chosen_of_those_asked_for(tmp_path):
    path = write_movie(tmp_path / "a.mp4", 48, **KEYS)
    assert set(chosen(path, "20-40x3")) <= set(range(20, 41, 3))
    assert chosen(path, "8") == [8]


@pytest.mark.parametrize(("count", "is_still"), [(96, False), (24, True)])
def test_black_and_white_and_repeated_frames_are_passed_over(tmp_path, count, is_still):
    images = [
        np.full_like(image, 255 * (n > count // 4)) if n < count // 2 else image
        for n, image in enumerate(pictures(count))
    ]
    if is_still:
        images = [images[-1]] * count
    numbers = chosen(write_movie(tmp_path / "a.mp4", count, images=images, options={"g": "1"}))
    assert len(numbers) == 1 if is_still else min(numbers) > count // 2


def test_a_black_movie_gives_its_frames_all_the_same(tmp_path):
    assert chosen(write_movie(tmp_path / "a.mp4", images=[np.zeros((96, 128, 3), np.uint8)] * 6)) == [1, 2, 3, 4, 5, 6]


def test_frames_have_names_bits_and_metadata(tmp_path):
    path = write_movie(tmp_path / "a.mp4", codec="libx265", form="yuv420p10le")
    number, photo = next(iter(chosen_photos(MovieFrames.find(path))))
    assert photo.path.name == f"a.mp4 frame {number}"
    assert photo.bit_depth == 10
    assert (photo.metadata.width, photo.metadata.height) == (128, 96)
    codes = photo.pixels * 1023
    assert abs(codes - codes.round()).max() < 1e-3
