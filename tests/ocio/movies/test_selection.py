"""The frames from which a response is estimated."""

import pytest

from crfnet.defaults import FRAMES_ANALYZED
from crfnet.movies.frames import MovieFrames
from crfnet.movies.selection import chosen_photos
from crfnet.movies.source import file_source
from crfnet.options import EstimateOptions
from crfnet.pipeline import estimate_files
from crfnet_core.errors import PhotoError
from crfnet_core.estimate.options import AnalysisOptions
from tests.helpers.movies import SOURCE, make_movie

pytest.importorskip("av", reason="needs PyAV: the extra video")

H264 = "-c:v libx264 -preset ultrafast -pix_fmt yuv420p -g 6"


def chosen(path, frames=None):
    return [number for number, _ in chosen_photos(MovieFrames.find(path, frames))]


def test_frames_are_spread_over_the_movie(tmp_path):
    numbers = chosen(make_movie(tmp_path / "a.mp4", H264, seconds=4))
    assert len(numbers) == FRAMES_ANALYZED
    assert numbers == sorted(set(numbers))
    assert all((number - 1) // 12 == part for part, number in enumerate(numbers)), "one in each eighth of 96"
    assert all(number % 6 == 1 for number in numbers), "key frames"


def test_frames_are_chosen_of_those_asked_for(tmp_path):
    path = make_movie(tmp_path / "a.mp4", H264, seconds=4)
    assert set(chosen(path, "20-40x3")) <= set(range(20, 41, 3))
    assert chosen(path, "7") == [7]


def test_black_and_white_frames_are_passed_over(tmp_path):
    source = "testsrc2=size=128x96:rate=24:duration={seconds}"
    source += ",drawbox=t=fill:color=black:enable='lt(n,48)',drawbox=t=fill:color=white:enable='between(n,48,71)'"
    numbers = chosen(make_movie(tmp_path / "a.mp4", H264, seconds=4, source=source))
    assert numbers
    assert min(numbers) > 72


def test_a_picture_that_stands_still_is_taken_once(tmp_path):
    source = "testsrc2=size=128x96:rate=24:duration={seconds},loop=loop=-1:size=1:start=0"
    numbers = chosen(make_movie(tmp_path / "a.mp4", f"{H264} -frames:v 96", seconds=1, source=source))
    assert len(numbers) == 1


def test_a_black_movie_gives_its_frames_all_the_same(tmp_path):
    path = make_movie(tmp_path / "a.mp4", H264, source="color=black:size=128x96:rate=24:duration={seconds}")
    assert chosen(path) == [1, 2, 3, 4, 5, 6]


def test_frames_have_names_bits_and_metadata(tmp_path):
    options = "-c:v libx265 -preset ultrafast -x265-params log-level=error -pix_fmt yuv420p10le"
    number, photo = next(iter(chosen_photos(MovieFrames.find(make_movie(tmp_path / "a.mp4", options)))))
    assert photo.path.name == f"a.mp4 frame {number}"
    assert photo.bit_depth == 10
    assert (photo.metadata.width, photo.metadata.height) == (128, 96)
    codes = photo.pixels * 1023
    assert abs(codes - codes.round()).max() < 1e-3


def test_a_published_curve_is_answered_with_its_color_space_unless_metadata_is_ignored(tmp_path, fixed_model):
    path = make_movie(tmp_path / "a.mp4", f"{H264} -color_trc arib-std-b67", source=SOURCE.replace("128x96", "320x240"))
    with pytest.raises(PhotoError) as told:
        estimate_files([file_source(path)], EstimateOptions(model=fixed_model))
    message = str(told.value)
    assert message.startswith(f"{path} frame 1: is encoded as HLG: so says its metadata (CICP)")
    assert 'in ACES configs "Rec.2100-HLG - Display"' in message
    options = EstimateOptions(model=fixed_model, analysis=AnalysisOptions(use_metadata=False))
    assert estimate_files([file_source(path)], options).movies
