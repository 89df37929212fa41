"""Movies: whatever is damaged, also in their metadata, a reader answers with frames or with one line."""

import numpy as np
import pytest

from crfnet.movies.source import find_source, photographs_of
from tests.helpers.mutations import mutated

av = pytest.importorskip("av", reason="movies need the movies extra")

#: Suffix -> encoder.
ENCODERS = {".mp4": "mpeg4", ".mov": "mjpeg", ".mkv": "ffv1", ".avi": "mpeg4"}


def movie(path, encoder):
    """The content of a small movie of six frames, whose title is not UTF-8."""
    rows, columns = np.mgrid[:48, :64]
    with av.open(str(path), "w") as container:
        container.metadata["title"] = "TITLE"
        stream = container.add_stream(encoder, rate=24)
        stream.width, stream.height = 64, 48
        stream.pix_fmt = "yuvj420p" if encoder == "mjpeg" else "yuv420p"
        for number in range(6):
            pixels = np.stack([rows * 4, columns * 3, rows + columns + 10 * number], axis=2).astype(np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(pixels, format="rgb24")))
        container.mux(stream.encode())
    return path.read_bytes().replace(b"TITLE", b"T\xe4\xff\x80E")


@pytest.fixture(scope="module")
def movies(tmp_path_factory):
    folder = tmp_path_factory.mktemp("movies")
    return {suffix: movie(folder / f"a{suffix}", encoder) for suffix, encoder in ENCODERS.items()}


def read_movie(path):
    return [photo for _, photo in photographs_of(find_source(path))]


def test_the_seeds_are_read(movies, tmp_path):
    for suffix, content in movies.items():
        path = tmp_path / f"a{suffix}"
        path.write_bytes(content)
        assert read_movie(path)


def test_damaged_movies_are_read_or_refused_in_one_line(fuzz, refused, movies, tmp_path):
    def case(generator):
        suffix = generator.choice(list(movies))
        path = tmp_path / f"a{suffix}"
        path.write_bytes(mutated(movies[suffix], generator))
        refused(read_movie, path)

    fuzz(case)
