"""Frames of movies are FFmpeg's own frames, for what users have."""

import numpy as np
import pytest

from crfnet.errors import PlateError
from crfnet.movies.frames import WHITE, MovieFrames
from crfnet.movies.stream import read_stream
from tests.helpers.movies import CODECS, ffmpeg_frames, make_movie

av = pytest.importorskip("av", reason="needs PyAV: the extra video")

#: zimg's names of the matrices.
MATRICES = {"BT.601": "170m", "BT.709": "709", "BT.2020": "2020_ncl", "RGB": "gbr"}

#: Codes by which frames may differ. The ProRes decoders of FFmpeg 5 and 8 differ by one code of YUV.
CODES = {"prores": 2, "prores 4444": 2}


def read_codes(frames):
    """All frames as codes of the stream's own depth, float, shape (frames, H, W, 3)."""
    largest = 2**frames.movie.bit_depth - 1
    loaded = [load() for load in frames.loaders(range(len(frames.numbers)))]
    assert {frame.largest for frame in loaded} == {WHITE}
    return np.stack([frame.samples for frame in loaded]) * (largest / WHITE)


def compare(path, codes=1):
    frames = MovieFrames.find(path)
    movie = frames.movie
    coding, size = movie.coding, (movie.width, movie.height)
    theirs = ffmpeg_frames(
        path, MATRICES[coding.matrix], coding.is_full_range, coding.is_centered, movie.bit_depth, size
    )
    ours = read_codes(frames)
    assert ours.shape == theirs.shape
    assert np.abs(ours - theirs).max() <= codes
    return frames


@pytest.mark.parametrize("name", CODECS)
def test_frames_are_those_of_ffmpeg(tmp_path, name):
    file, options = CODECS[name]
    frames = compare(make_movie(tmp_path / file, options), CODES.get(name, 1))
    bits = 12 if name == "prores 4444" else 10 if "10" in name or name == "prores" else 8
    assert frames.movie.bit_depth == bits
    assert frames.numbers == tuple(range(1, 7))


@pytest.mark.parametrize(
    ("tag", "matrix"),
    [("bt709", "BT.709"), ("smpte170m", "BT.601"), ("bt470bg", "BT.601"), ("bt2020nc", "BT.2020")],
)
def test_the_matrix_is_that_of_the_tag(tmp_path, tag, matrix):
    path = make_movie(tmp_path / "a.mp4", f"-c:v libx264 -preset ultrafast -pix_fmt yuv420p -colorspace {tag}")
    assert compare(path).movie.coding.matrix == matrix


@pytest.mark.parametrize(("lines", "matrix"), [(718, "BT.601"), (720, "BT.709")])
def test_untagged_streams_follow_the_number_of_lines(tmp_path, lines, matrix):
    source = f"testsrc2=size=64x{lines}:rate=24:duration=0.1"
    options = "-c:v libx264 -preset ultrafast -pix_fmt yuv420p"
    movie = compare(make_movie(tmp_path / "a.mp4", options, source=source)).movie
    assert movie.coding.matrix == matrix
    assert f"the stream does not say its matrix: {matrix} taken, as it has {lines} lines" in str(movie)
    assert "the stream does not say its range: limited taken" in str(movie)


def test_tagged_streams_have_no_assumptions(tmp_path):
    options = "-c:v libx264 -preset ultrafast -pix_fmt yuv420p -colorspace bt709 -color_range tv"
    assert "does not say" not in str(read_stream(make_movie(tmp_path / "a.mp4", options)))


def test_limited_and_full_range_of_one_picture_agree(tmp_path):
    source = "testsrc2=size=128x96:rate=24:duration=0.1,format=gray"
    both = []
    for name, color_range in (("limited", "tv"), ("full", "pc")):
        scale = f"-vf scale=out_range={color_range} -color_range {color_range} -qp 0"
        options = f"-c:v libx264 -preset ultrafast -pix_fmt yuv444p {scale}"
        both.append(MovieFrames.find(make_movie(tmp_path / f"{name}.mp4", options, source=source)))
    assert [frames.movie.coding.is_full_range for frames in both] == [False, True]
    difference = np.abs(read_codes(both[0]) - read_codes(both[1]))
    assert difference.max() <= 2


def test_odd_sizes_are_read(tmp_path):
    source = "testsrc2=size=160x120:rate=24:duration=0.1,format=gbrp,crop=131:97"
    options = "-c:v libvpx-vp9 -deadline realtime -cpu-used 8 -pix_fmt yuv420p"
    frames = MovieFrames.find(make_movie(tmp_path / "a.webm", options, source=source))
    ours = read_codes(frames)
    assert ours.shape == (3, 97, 131, 3)
    theirs = ffmpeg_frames(frames.movie.path, "170m", False, False, 8, (130, 96), "crop=130:96:0:0")  # zimg needs even
    np.testing.assert_allclose(ours[:, :95, :129], theirs[:, :95, :129], atol=1)


def test_alpha_is_kept(tmp_path):
    source = "color=red@0.5:size=64x64:rate=24:duration=0.1,format=yuva444p10le"
    path = make_movie(tmp_path / "a.mov", "-c:v prores_ks -profile:v 4444 -pix_fmt yuva444p10le", source=source)
    frame = next(MovieFrames.find(path).loaders([0]))()
    assert frame.alpha is not None
    np.testing.assert_allclose(frame.alpha, 0.5, atol=0.01)
    np.testing.assert_allclose(frame.samples[32, 32] / WHITE, (1, 0, 0), atol=0.02)


def test_gray_becomes_rgb(tmp_path):
    path = make_movie(tmp_path / "a.mkv", "-c:v ffv1 -pix_fmt gray")
    frames = MovieFrames.find(path)
    frame = next(frames.loaders([0]))()
    assert (frame.samples == frame.samples[..., :1]).all()
    assert next(frames.photos([1]))[1].is_gray


def gray_movie(path, form, color_range):
    """A movie of one frame with a ramp of all 256 gray codes, encoded by PyAV without loss."""
    frame = av.VideoFrame(256, 16, form)
    plane, samples = frame.planes[0], 2 if form == "ya8" else 1
    lines = np.full((plane.height, plane.line_size), 200, np.uint8)
    lines[:, : 256 * samples : samples] = np.arange(256)
    plane.update(lines.tobytes())
    frame.color_range = color_range
    with av.open(str(path), "w") as container:
        stream = container.add_stream("ffv1", rate=24)
        stream.width, stream.height, stream.pix_fmt = 256, 16, form
        stream.codec_context.color_range = color_range
        container.mux([*stream.encode(frame), *stream.encode()])
    return MovieFrames.find(path)


@pytest.mark.parametrize("form", ["gray", "ya8"])
@pytest.mark.parametrize(("color_range", "is_full"), [(0, True), (1, False), (2, True)])
def test_gray_has_full_range_unless_it_is_tagged(tmp_path, form, color_range, is_full):
    frames = gray_movie(tmp_path / "a.mkv", form, color_range)
    codes = np.arange(256.0)
    expected = codes if is_full else np.clip((codes - 16) * 255 / 219, 0, 255)
    np.testing.assert_allclose(read_codes(frames)[0, 0], np.repeat(expected[:, None], 3, axis=1), atol=0.01)
    said = str(frames.movie)
    assert f"; RGB, {'full' if is_full else 'limited'} range" in said
    assert ("the stream does not say its range: full taken, as it is gray" in said) == (color_range == 0)
    assert "matrix" not in said


def test_other_matrices_are_refused(tmp_path):
    path = make_movie(tmp_path / "a.mp4", "-c:v libx264 -preset ultrafast -pix_fmt yuv444p -colorspace ycgco")
    with pytest.raises(PlateError, match=r"a\.mp4: cannot be decoded \(pixels of yuv444p, matrix 8 of H\.273\)"):
        read_stream(path)
