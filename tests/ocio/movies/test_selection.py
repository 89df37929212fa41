import os
from itertools import permutations

import numpy as np
import pytest

from crfnet.defaults import FRAMES_ANALYZED
from crfnet.errors import PlateError
from crfnet.movies.frames import MovieFrames
from crfnet.movies.library import is_movie
from crfnet.movies.source import chosen_photos
from crfnet.movies.stream import read_stream
from tests.helpers.folders import written
from tests.helpers.images import write_image
from tests.helpers.movies import pictures, run_ffmpeg, write_movie
from tests.helpers.refusals import refusal_of

av = pytest.importorskip("av", reason="needs PyAV: the extra video")

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
    images = [*pictures(count)]
    plain = [np.full_like(images[0], 255 * (number > count // 4)) for number in range(count // 2)]
    images = [images[-1]] * count if is_still else plain + images[count // 2 :]
    numbers = chosen(write_movie(tmp_path / "a.mp4", count, images=images, options={"g": "1"}))
    assert len(numbers) == 1 if is_still else min(numbers) > count // 2


def test_a_black_movie_gives_its_frames_all_the_same(tmp_path):
    assert chosen(write_movie(tmp_path / "a.mp4", images=[np.zeros((96, 128, 3), np.uint8)] * 6)) == [1, 2, 3, 4, 5, 6]


def test_frames_have_names_bits_and_metadata(tmp_path):
    path = write_movie(tmp_path / "a.mp4", codec="libx265", form="yuv420p10le")
    number, photo = next(iter(chosen_photos(MovieFrames.find(path))))
    assert (photo.path.name, photo.bit_depth) == (f"a.mp4 frame {number}", 10)
    assert (photo.metadata.width, photo.metadata.height) == (128, 96)
    codes = photo.pixels * 1023
    assert abs(codes - codes.round()).max() < 1e-3


FORMS = {"libx264": "yuv420p", "mjpeg": "yuvj420p"}


@pytest.mark.parametrize(("codec", "other"), [*permutations(FORMS)])
@pytest.mark.parametrize(("name", "side"), [("a.mov", 64), ("a.mkv", 480)])
def test_the_film_is_taken_and_not_the_thumbnail_before_it(tmp_path, name, side, codec, other):
    with av.open(str(tmp_path / name), "w") as container:
        thumbnail, film = container.add_stream(other, rate=24), container.add_stream(codec, rate=24)
        (film if side < 96 else thumbnail).disposition = av.stream.Disposition.default
        thumbnail.width, thumbnail.height, thumbnail.pix_fmt = side, side, FORMS[other]
        film.width, film.height, film.pix_fmt = 128, 96, FORMS[codec]
        for stream, count in ((thumbnail, 1), (film, 12)):
            for image in pictures(count, (stream.width, stream.height)):
                frame = av.VideoFrame.from_ndarray(image, format="rgb24").reformat(format=stream.pix_fmt)
                container.mux(stream.encode(frame))
            container.mux(stream.encode())
    result = read_stream(tmp_path / name)
    assert (result.picture.size, result.frame_count) == ((128, 96), 12)


def test_a_cover_is_not_a_film(tmp_path):
    cover = {"codec": "mjpeg", "form": "yuvj420p", "disposition": av.stream.Disposition.attached_pic}
    path = write_movie(tmp_path / "a.mp4", 1, **cover)
    assert is_movie(path)
    assert refusal_of(PlateError, read_stream, path).code == "no_video"


def test_what_is_not_a_movie(tmp_path):
    for name in ("a.png", "a.jpg", "a.tif", "a.webp", "a.exr"):
        write_image(tmp_path / name, np.zeros((8, 8, 3), np.uint8))
    (tmp_path / "a.heic").write_bytes(b"\0\0\0\x18ftypheic\0\0\0\0mif1heic")
    (tmp_path / "empty.mp4").write_bytes(b"")
    (tmp_path / "a.ico").write_bytes(b"\0\0\1\0\1\0")
    assert not any(is_movie(path) for path in (*tmp_path.iterdir(), tmp_path / "absent.mp4", tmp_path))


@pytest.mark.parametrize("head", ["1f0700bf", "b7d80020", "0000000001bc", "000001b0", "00000167", "47" + 203 * "00"])
def test_movies_are_known_by_their_first_bytes(tmp_path, head):
    """DV, Windows TV, GXF, bare MPEG-4 and H.264, and a transport stream with error correction."""
    assert is_movie(written(tmp_path / "a", 600 * bytes.fromhex(head)))


@pytest.mark.parametrize(
    ("name", "codec", "form"),
    [("a.mp4", "libx264", "yuv420p"), ("a.mov", "png", "rgb24"), ("a.mkv", "ffv1", "yuv420p")],
)
def test_a_movie_of_too_large_frames_is_refused_before_one_is_decoded(tmp_path, monkeypatch, name, codec, form):
    """FFmpeg itself decodes some to learn their form."""
    path = write_movie(tmp_path / name, codec=codec, form=form)
    read_stream(path)
    monkeypatch.setattr("crfnet.movies.library.MOST_PIXELS", 128 * 96 - 1)
    monkeypatch.setattr("crfnet.movies.stream.decoded_packet", None)
    assert refusal_of(PlateError, read_stream, path).code == "movie_too_large"


def test_opening_a_movie_of_many_empty_boxes_ends(tmp_path, monkeypatch):
    movie = write_movie(tmp_path / "a.mp4")
    written(movie, movie.read_bytes() + 100_000 * b"\0\0\0\x08free")
    monkeypatch.setattr("crfnet.movies.library.OPENING", 0.01)
    assert refusal_of(PlateError, read_stream, movie).code == "movie_undecodable"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_a_pipe_is_not_opened(tmp_path):
    """That would wait for a writer; here there is one, so that the test would not."""
    os.mkfifo(tmp_path / "a.avi")
    writer = os.open(tmp_path / "a.avi", os.O_RDWR)
    try:
        os.write(writer, b"RIFF....AVI ".ljust(600, b"\0"))
        assert not is_movie(tmp_path / "a.avi")
    finally:
        os.close(writer)


def test_columns_that_h264_crops_on_the_left_are_left_out(tmp_path):
    path, target = write_movie(tmp_path / "a.mp4", 1), tmp_path / "b.mp4"
    run_ffmpeg("-i", path, "-c", "copy", "-bsf:v", "h264_metadata=crop_left=16:crop_right=6", target)
    whole, cropped = (next(MovieFrames.find(each).loaders([0]))().samples for each in (path, target))
    np.testing.assert_array_equal(cropped[:, :-1], whole[:, 16:-7])  # the last chroma sample has no neighbor
