"""Which files are movies, and which of their streams is the film."""

import os
from itertools import permutations

import numpy as np
import pytest

from crfnet.errors import PlateError
from crfnet.movies.library import is_movie
from crfnet.movies.stream import read_stream
from tests.helpers.images import write_image
from tests.helpers.movies import pictures
from tests.helpers.refusals import refused

av = pytest.importorskip("av", reason="needs PyAV: the extra video")

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
    with av.open(str(tmp_path / "a.mp4"), "w") as container:
        sound, cover = container.add_stream("aac", rate=8000, layout="mono"), container.add_stream("mjpeg", rate=24)
        cover.width, cover.height, cover.pix_fmt = 128, 96, "yuvj420p"
        cover.disposition = av.stream.Disposition.attached_pic
        frame = av.AudioFrame.from_ndarray(np.zeros((1, 1024), np.float32), format="fltp", layout="mono")
        frame.rate = 8000
        container.mux([*sound.encode(frame), *sound.encode()])
        picture = av.VideoFrame.from_ndarray(next(pictures(1)), format="rgb24").reformat(format="yuvj420p")
        container.mux([*cover.encode(picture), *cover.encode()])
    assert is_movie(tmp_path / "a.mp4")
    with refused(PlateError, "no_video"):
        read_stream(tmp_path / "a.mp4")


def test_what_is_not_a_movie(tmp_path):
    for name in ("a.png", "a.jpg", "a.tif", "a.webp", "a.exr"):
        write_image(tmp_path / name, np.zeros((8, 8, 3), np.uint8))
    (tmp_path / "a.heic").write_bytes(b"\0\0\0\x18ftypheic\0\0\0\0mif1heic")
    (tmp_path / "empty.mp4").write_bytes(b"")
    assert not any(is_movie(path) for path in (*tmp_path.iterdir(), tmp_path / "absent.mp4", tmp_path))


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
