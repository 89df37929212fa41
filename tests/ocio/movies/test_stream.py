"""What a movie says of its pictures."""

import os
import struct
from fractions import Fraction

import numpy as np
import pytest

from crfnet.errors import PlateError
from crfnet.movies import log_tags
from crfnet.movies.frames import MovieFrames
from crfnet.movies.header import frame_header, movie_metadata
from crfnet.movies.library import is_movie
from crfnet.movies.stream import check_progressive, read_stream
from crfnet_core.colorimetry import DISPLAY_P3, REC709, REC2020
from crfnet_core.photograph.metadata import file_origin
from crfnet_core.photograph.metadata.color_tags import PRIMARIES, ColorTags
from tests.helpers.images import write_image
from tests.helpers.movies import INTERLACED, make_movie, run_ffmpeg

pytest.importorskip("av", reason="needs PyAV: the extra video")

H264 = "-c:v libx264 -preset ultrafast -pix_fmt yuv420p"


@pytest.fixture(scope="module")
def movie(tmp_path_factory):
    """Six frames with a timecode."""
    return make_movie(tmp_path_factory.mktemp("movie") / "a.mp4", f"{H264} -timecode 01:00:00:00")


@pytest.mark.parametrize(
    ("tag", "primaries"),
    [
        ("bt709", REC709),
        ("bt2020", REC2020),
        ("smpte432", DISPLAY_P3),
        ("smpte170m", PRIMARIES[6]),
        ("film", PRIMARIES[8]),
    ],
)
def test_primaries_are_those_of_the_tag(tmp_path, tag, primaries):
    found = read_stream(make_movie(tmp_path / "a.mp4", f"{H264} -color_primaries {tag} -color_trc bt709"))
    assert (found.color.primaries, found.color.source) == (primaries, "CICP")
    assert found.color.transfer == ""
    assert movie_metadata(found).color == found.color


def test_untagged_streams_say_nothing_of_colors(movie):
    found = read_stream(movie).color
    assert (found.primaries, found.transfer, found.source) == (None, "", "")


@pytest.mark.parametrize(("tag", "name"), [("arib-std-b67", "HLG"), ("smpte2084", "PQ"), ("log100", "log 100:1")])
def test_published_curves_are_named(tmp_path, tag, name):
    found = read_stream(make_movie(tmp_path / "a.mp4", f"{H264} -color_primaries bt2020 -color_trc {tag}"))
    assert (found.color.transfer, found.color.source) == (name, "CICP")
    assert f"; tagged {name}" in str(found)


def boxed(kind, content):
    return struct.pack(">I4s", 8 + len(content), kind) + content


SONY = '<AcquisitionRecord><Group name="CameraUnitMetadataSet"><Item name="CaptureGammaEquation" value="{}"/></Group>'


@pytest.mark.parametrize(
    ("content", "name"),
    [
        (b"com.apple.rec2020.apple-log", "Apple Log"),
        (b"com.apple.apple-wide-gamut.apple-log", "Apple Log 2"),
        (SONY.format("s-log3-cine").encode(), "Sony S-Log3"),
        (SONY.format("s-log3").encode(), "Sony S-Log3 in S-Gamut3"),
        (SONY.format("s-log2").encode(), "Sony S-Log2"),
        (b"<Gamma>\n  <CaptureGamma>V-Log</CaptureGamma>\n</Gamma>", "Panasonic V-Log"),
    ],
)
def test_log_curves_that_makers_write_are_named(movie, tmp_path, content, name):
    path = tmp_path / "log.mp4"
    path.write_bytes(movie.read_bytes() + boxed(b"meta", content))
    assert read_stream(path).color == ColorTags(None, name, "the maker's entry")


def test_a_log_curve_is_named_beside_the_tag_of_its_primaries(tmp_path):
    path = make_movie(tmp_path / "log.mp4", f"{H264} -color_primaries bt2020")
    path.write_bytes(path.read_bytes() + boxed(b"meta", b"com.apple.rec2020.apple-log"))
    assert read_stream(path).color == ColorTags(REC2020, "Apple Log", "CICP and the maker's entry")


CAPTION = "1\n00:00:00,000 --> 00:00:00,033\n<font>FrameCnt: 1\n[iso: 100] [color_md : {}] [focal_len: 24.00]</font>"


@pytest.mark.parametrize(
    ("name", "content", "curve"),
    [
        ("C0001M01.XML", SONY.format("s-log3-cine"), "Sony S-Log3"),
        ("C0001.SRT", CAPTION.format("d_log"), "DJI D-Log"),
        ("C0001.SRT", CAPTION.format("dlog_m"), ""),
        ("C0001.SRT", CAPTION.format("default"), ""),
        ("C0002M01.XML", SONY.format("s-log3-cine"), ""),
    ],
)
def test_log_curves_that_cameras_write_beside_a_movie_are_named(movie, tmp_path, name, content, curve):
    path = tmp_path / "C0001.MP4"
    path.write_bytes(movie.read_bytes())
    (tmp_path / name).write_text(content, encoding="utf-8")
    assert read_stream(path).color.transfer == curve


@pytest.mark.parametrize(
    "content", [SONY.format("rec709").encode(), b"<CaptureGamma>HD</CaptureGamma>", b"s-log3-cine", b"apple-log"]
)
def test_other_texts_name_no_curve(movie, tmp_path, content):
    path = tmp_path / "plain.mp4"
    path.write_bytes(movie.read_bytes() + boxed(b"meta", content))
    assert read_stream(path).color == ColorTags()


def test_texts_among_the_pictures_name_no_curve(movie, tmp_path):
    path = tmp_path / "plain.mp4"
    path.write_bytes(movie.read_bytes() + boxed(b"mdat", b"com.apple.rec2020.apple-log"))
    assert read_stream(path).color == ColorTags()


def test_arri_names_its_curve():
    assert log_tags.log_curve(None, {"com.arri.camera.ColorGammaSxS": "LOG-C"}) == log_tags.ARRI_CURVE


def test_frame_rate_timecode_and_pixel_aspect(tmp_path):
    options = f"{H264} -r 30000/1001 -timecode 00:00:59;29 -aspect 2:1"
    found = read_stream(make_movie(tmp_path / "a.mov", options))
    assert (found.rate, str(found.timecode)) == (Fraction(30000, 1001), "00:00:59;29")
    assert found.pixel_aspect == Fraction(3, 2)
    header = frame_header(found, 2)
    assert header.getattribute("FramesPerSecond") == (30000, 1001)
    assert header.get_string_attribute("smpte:TimeCode") == "00:01:00:02"  # OpenImageIO writes no semicolon
    assert header.get_float_attribute("PixelAspectRatio") == 1.5


def test_maker_and_model_are_evidence(tmp_path):
    tags = "-movflags use_metadata_tags -metadata com.apple.quicktime.make=Apple"
    tags += " -metadata com.apple.quicktime.model=iPhone"
    found = movie_metadata(read_stream(make_movie(tmp_path / "a.mov", f"{H264} {tags}")))
    assert (found.make, found.model, found.file_format) == ("Apple", "iPhone", "movie")
    origin = file_origin(found)
    assert origin.device == "phone"
    assert origin.words == ("taken by Apple iPhone, a phone", "a frame of a movie")


MATRICES = {90: (0, 1, -1, 0), 180: (-1, 0, 0, -1), 270: (0, -1, 1, 0), "mirrored": (-1, 0, 0, 1)}


@pytest.mark.parametrize("turn", MATRICES)
def test_frames_are_upright(movie, tmp_path, turn):
    """The matrix of the track header is replaced; FFmpeg then turns its own frames."""
    content = movie.read_bytes()
    identity = struct.pack(">9i", 65536, 0, 0, 0, 65536, 0, 0, 0, 1 << 30)
    start = content.index(identity, content.index(b"tkhd"))
    a, b, c, d = (65536 * value for value in MATRICES[turn])
    turned = tmp_path / "turned.mp4"
    matrix = struct.pack(">9i", a, b, 0, c, d, 0, 0, 0, 1 << 30)
    turned.write_bytes(content[:start] + matrix + content[start + len(identity) :])
    frame, stored = (next(MovieFrames.find(path).loaders([0]))().samples for path in (turned, movie))
    expected = {
        90: np.rot90(stored, -1),
        180: np.rot90(stored, 2),
        270: np.rot90(stored),
        "mirrored": stored[:, ::-1],
    }[turn]
    np.testing.assert_array_equal(frame, expected)
    if turn != "mirrored":
        raw = run_ffmpeg("-i", turned, "-frames:v", 1, "-pix_fmt", "gray", "-f", "rawvideo", "-")
        theirs = np.frombuffer(raw, np.uint8).reshape(frame.shape[:2])
        correlation = np.corrcoef(theirs.ravel(), frame[..., 1].ravel())[0, 1]
        assert correlation > 0.8


def test_turned_pixels_swap_their_sides(tmp_path):
    movie = make_movie(tmp_path / "a.mp4", f"{H264} -aspect 2:1")
    run_ffmpeg("-i", movie, "-c", "copy", "-metadata:s:v", "rotate=90", tmp_path / "b.mp4")
    found = read_stream(tmp_path / "b.mp4")
    assert (found.width, found.height, found.pixel_aspect) == (96, 128, Fraction(2, 3))


def test_what_is_a_movie(movie, tmp_path):
    for name in ("a.mkv", "a.avi", "a.mxf", "a.ts", "a.mpg"):
        codec = "mpeg2video" if name in ("a.mxf", "a.mpg") else "libx264"
        run_ffmpeg("-i", movie, "-c:v", codec, "-r", 25, tmp_path / name)
        assert is_movie(tmp_path / name), name
    assert is_movie(movie)
    for name in ("a.png", "a.jpg", "a.tif", "a.webp", "a.exr"):
        write_image(tmp_path / name, np.zeros((8, 8, 3), np.uint8))
        assert not is_movie(tmp_path / name), name
    (tmp_path / "a.heic").write_bytes(b"\0\0\0\x18ftypheic\0\0\0\0mif1heic")
    (tmp_path / "empty.mp4").write_bytes(b"")
    for name in ("a.heic", "empty.mp4", "absent.mp4", ""):
        assert not is_movie(tmp_path / name), name


def test_damaged_movies_are_refused_with_the_ffmpeg_line(movie, tmp_path):
    path = tmp_path / "cut short.mp4"
    path.write_bytes(movie.read_bytes()[:2000])
    with pytest.raises(PlateError) as told:
        read_stream(path)
    message = str(told.value)
    assert message.startswith(f"{path}: cannot be decoded (Invalid data found when processing input); copy it again")
    assert f"ffmpeg -i '{path}' " in message
    assert "\n" not in message


def test_sound_alone_is_refused(tmp_path):
    run_ffmpeg("-f", "lavfi", "-i", "sine=duration=0.1", tmp_path / "a.mp4")
    with pytest.raises(PlateError, match="holds no video"):
        read_stream(tmp_path / "a.mp4")


def test_interlaced_movies_are_named(tmp_path):
    found = read_stream(make_movie(tmp_path / "a.mp4", INTERLACED))
    assert "; interlaced: its frames mix two moments" in str(found)
    with pytest.raises(PlateError, match="is interlaced"):
        check_progressive(found)


def test_progressive_movies_pass(movie):
    check_progressive(read_stream(movie))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_a_pipe_is_no_movie(tmp_path):
    """It is not opened, which would wait for a writer; here there is one, so that the test would not."""
    os.mkfifo(tmp_path / "a.avi")
    writer = os.open(tmp_path / "a.avi", os.O_RDWR)
    try:
        os.write(writer, b"RIFF....AVI ".ljust(600, b"\0"))
        assert not is_movie(tmp_path / "a.avi")
    finally:
        os.close(writer)
