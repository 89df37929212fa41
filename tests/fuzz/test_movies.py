import pytest

from crfnet.movies.frames import MovieFrames
from tests.helpers.movies import write_movie
from tests.helpers.mutations import mutated

#: Name of a seed, its encoder and pixel format.
SEEDS = {
    "a.mp4": ("libx264", "yuv420p"),
    "a.mov": ("prores_ks", "yuv422p10le"),
    "a.mkv": ("ffv1", "yuv444p"),
    "a.avi": ("mjpeg", "yuvj420p"),
    "a.ts": ("mpeg2video", "yuv420p"),
}


@pytest.fixture(scope="module")
def seeds(tmp_path_factory):
    folder = tmp_path_factory.mktemp("movies")
    metadata = {"title": "Voigtlander in June", "make": "Canon", "comment": "x"}
    paths = [
        write_movie(folder / name, 4, codec=codec, form=form, size=(64, 48), metadata=metadata)
        for name, (codec, form) in SEEDS.items()
    ]
    return {path.name: path.read_bytes() for path in paths}


def test_damaged_movies_are_read_or_refused_in_one_line(fuzz, refused, seeds, tmp_path):
    def read(path):
        source = MovieFrames.find(path)
        str(source.movie)
        for number, _ in zip(source.photos(source.numbers), range(3), strict=False):
            assert number
        for load, _ in zip(source.loaders(range(len(source.numbers))), range(3), strict=False):
            load()

    def case(generator):
        name = list(seeds)[generator.integers(len(seeds))]
        path = tmp_path / name
        path.write_bytes(mutated(seeds[name], generator))
        refused(read, path)

    fuzz(case)
