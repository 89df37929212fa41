"""Frames by number are the same whichever others are read, and few are decoded."""

import numpy as np
import pytest

from crfnet.movies import decoding
from crfnet.movies.decoding import decoded
from crfnet.movies.frames import MovieFrames
from crfnet.movies.index import FrameIndex
from crfnet.movies.stream import read_stream
from tests.helpers.movies import make_movie, run_ffmpeg

pytest.importorskip("av", reason="needs PyAV: the extra video")

#: Movies of 48 frames with a key frame every 12: B-frames; open groups of pictures; no index; intra only; odd times.
MOVIES = {
    "h264": ("a.mp4", "-c:v libx264 -preset fast -g 12 -bf 3 -sc_threshold 0 -pix_fmt yuv420p"),
    "hevc": ("b.mp4", "-c:v libx265 -preset fast -x265-params log-level=error:keyint=12:open-gop=1 -pix_fmt yuv420p"),
    "webm": ("c.webm", "-c:v libvpx-vp9 -deadline realtime -cpu-used 8 -g 12 -pix_fmt yuv420p"),
    "transport stream": ("d.ts", "-c:v libx264 -preset fast -g 12 -bf 3 -sc_threshold 0 -pix_fmt yuv420p"),
    "prores": ("e.mov", "-c:v prores_ks -profile:v 0 -pix_fmt yuv422p10le"),
}


@pytest.fixture(scope="module")
def movies(tmp_path_factory):
    """The movies of `MOVIES`, made when asked for."""
    folder = tmp_path_factory.mktemp("movies")

    def make(name):
        file, options = MOVIES[name]
        return folder / file if (folder / file).exists() else make_movie(folder / file, options, seconds=2)

    return make


def arrays(movie, numbers):
    return {number: frame.to_ndarray(format="gray") for number, frame in decoded(movie, numbers)}


@pytest.mark.parametrize("name", MOVIES)
def test_frames_do_not_depend_on_the_others(movies, name):
    movie = read_stream(movies(name))
    assert len(movie.index.times) == 48
    everything = arrays(movie, range(1, 49))
    assert list(everything) == list(range(1, 49))
    for numbers in ([48], [25], [30], [2, 3, 40], [12, 13, 14], range(1, 48, 7)):
        for number, frame in arrays(movie, numbers).items():
            np.testing.assert_array_equal(frame, everything[number])


@pytest.mark.parametrize("name", ["h264", "hevc", "webm", "prores"])
def test_decoding_begins_at_the_key_frame_before(movies, name, monkeypatch):
    movie = read_stream(movies(name))
    keys = (1, 13, 25, 37) if name != "prores" else tuple(range(1, 49))
    assert movie.index.key_numbers == keys
    seen = []

    def watched(*arguments):
        for number, frame in actual(*arguments):
            seen.append(number)
            yield number, frame

    actual = decoding._decoded_from
    monkeypatch.setattr(decoding, "_decoded_from", watched)
    list(decoded(movie, [3, 40]))
    assert 40 in seen
    assert not {number for number in seen if number > 3} & set(range(8, 34)), (
        "the groups of pictures between are skipped"
    )


def test_numbers_are_read_once_and_ascending(movies):
    movie = read_stream(movies("h264"))
    assert [number for number, _ in decoded(movie, [9, 3, 9])] == [3, 9]
    assert list(decoded(movie, [])) == []


def test_frames_with_uneven_times_are_all_numbered(tmp_path):
    source = "testsrc2=size=128x96:rate=24:duration={seconds},select='not(eq(mod(n,5),3))'"
    path = make_movie(
        tmp_path / "a.mp4", "-vsync passthrough -c:v libx264 -preset fast -pix_fmt yuv420p", seconds=1, source=source
    )
    frames = MovieFrames.find(path)
    assert len(set(np.diff(frames.movie.index.times))) > 1
    assert frames.numbers == tuple(range(1, 20))
    assert len(list(decoded(frames.movie, frames.numbers))) == 19


def test_what_an_edit_list_cuts_off_has_no_number(movies, tmp_path):
    run_ffmpeg("-ss", 0.3, "-i", movies("h264"), "-c", "copy", tmp_path / "cut.mp4")
    movie = read_stream(tmp_path / "cut.mp4")
    frames = list(decoded(movie, range(1, len(movie.index.times) + 1)))
    assert 40 <= len(frames) < 48
    assert all(frame is not None for _, frame in frames)
    shown = run_ffmpeg("-i", tmp_path / "cut.mp4", "-vsync", "passthrough", "-pix_fmt", "gray", "-f", "rawvideo", "-")
    theirs = np.frombuffer(shown, np.uint8).reshape(-1, 96, 128)
    assert len(theirs) == len(frames)


def test_a_damaged_frame_is_none_and_the_others_are_there(movies, tmp_path):
    content = bytearray(movies("prores").read_bytes())
    place = len(content) // 2
    content[place : place + 4000] = bytes(4000)
    path = tmp_path / "damaged.mov"
    path.write_bytes(content)
    frames = dict(decoded(read_stream(path), range(1, 49)))
    assert list(frames) == list(range(1, 49))
    damaged = [number for number, frame in frames.items() if frame is None]
    assert 1 <= len(damaged) <= 3


def test_the_key_frame_before():
    index = FrameIndex(times=(0, 10, 20, 30, 40), key_times=(10, 30))
    assert [index.key_before(number) for number in (1, 2, 3, 4, 5)] == [1, 2, 2, 4, 4]
