import shlex
import struct
from fractions import Fraction

import numpy as np
import pytest

from crfnet.errors import PlateError
from crfnet.movies.frames import MovieFrames
from crfnet.movies.stream import check_progressive, read_stream
from crfnet_core.colorimetry import REC709, REC2020
from crfnet_core.photograph.metadata import file_origin
from tests.helpers.crafted_files import box
from tests.helpers.folders import changed
from tests.helpers.images import read_image, write_image
from tests.helpers.movies import pictures, run_ffmpeg, write_movie
from tests.helpers.refusals import refusal_of


def with_box(path, added):
    """Insert a box in front of the decoder configuration of a HEVC movie whose header stands at the end."""
    content = path.read_bytes()
    at = content.index(b"hvcC") - 4
    assert content.index(b"mdat") < at
    content = bytearray(content[:at] + added + content[at:])
    for name in (b"moov", b"trak", b"mdia", b"minf", b"stbl", b"stsd", b"hev1"):
        place = content.index(name) - 4
        struct.pack_into(">I", content, place, struct.unpack_from(">I", content, place)[0] + len(added))
    path.write_bytes(content)


def test_dolby_vision_of_profile_5_is_refused(tmp_path):
    movies = [write_movie(tmp_path / f"{profile}.mp4", codec="libx265") for profile in (5, 8)]
    for path in movies:
        with_box(path, box(b"dvcC", bytes([1, 0, int(path.stem) << 1, 13, 0]), bytes(19)))
    assert refusal_of(PlateError, read_stream, movies[0]).code == "dolby_vision"
    assert read_stream(movies[1]).codec == "HEVC"


def test_metadata_that_is_not_utf8_is_read(tmp_path):
    path = write_movie(tmp_path / "a.mov", metadata={"title": "Voigt"})
    assert read_stream(changed(path, b"Voigt", b"Vo\xefgt")).metadata["title"] == "Vo\ufffdgt"


def test_maker_model_rate_and_timecode(tmp_path):
    tags = {"com.apple.quicktime.make": "Apple", "com.apple.quicktime.model": "iPhone", "timecode": "01:00:00:00"}
    path = write_movie(tmp_path / "a.mov", metadata=tags, muxer={"movflags": "use_metadata_tags"})
    result = read_stream(path)
    assert (result.rate, "timecode 01:00:00:00" in str(result)) == (Fraction(24), True)
    assert file_origin(result.file_metadata).words == ("taken by Apple iPhone, a phone", "a frame of a movie")
    header = next(MovieFrames.find(path).loaders([0]))().header
    assert header.getattribute("FramesPerSecond") == (24, 1)
    assert header.get_string_attribute("Model") == "iPhone"


@pytest.mark.parametrize(
    ("tags", "metadata", "transfer"),
    [
        ({"color_trc": 16}, {}, "PQ"),
        ({"color_trc": 1}, {}, ""),
        ({}, {"com.arri.camera.ColorGammaSxS": "LOG-C"}, "ARRI LogC3"),
        ({}, {"com.panasonic.Semi-Pro.metadata.xml": "<CaptureGamma> V-Log </CaptureGamma>"}, "Panasonic V-Log"),
    ],
)
def test_published_curves_are_known_by_tags_and_metadata(tmp_path, tags, metadata, transfer):
    path = write_movie(tmp_path / "a.mov", tags=tags, metadata=metadata, muxer={"movflags": "use_metadata_tags"})
    assert read_stream(path).color.transfer == transfer


def test_the_container_counts_where_frames_have_no_tags(tmp_path):
    """As in ProRes, whose frames leave them open while the file of QuickTime has them."""
    tags = {"colorspace": 9, "color_range": 1, "color_primaries": 9, "color_trc": 16}
    movie = read_stream(write_movie(tmp_path / "a.mov", codec="prores_ks", form="yuv422p10le", tags=tags))
    assert movie.picture.coding.matrix == "BT.2020"
    assert (movie.color.primaries, movie.color.transfer) == (REC2020, "PQ")


@pytest.mark.parametrize(("codes", "expected"), [((9, 16), (REC2020, "PQ")), ((9, 14), (REC709, ""))])
def test_pq_in_the_container_outweighs_what_the_stream_says(tmp_path, codes, expected):
    tags = {"colorspace": 1, "color_range": 1, "color_primaries": 1, "color_trc": 1}
    path = write_movie(tmp_path / "a.mp4", tags=tags)
    movie = read_stream(changed(path, b"nclx" + struct.pack(">HH", 1, 1), b"nclx" + struct.pack(">HH", *codes)))
    assert (movie.picture.coding.matrix, movie.color.primaries, movie.color.transfer) == ("BT.709", *expected)


@pytest.mark.parametrize(("codec", "is_interlaced"), [("huffyuv", True), ("prores_ks", False)])
def test_the_container_counts_where_frames_do_not_say_whether_they_hold_two_fields(tmp_path, codec, is_interlaced):
    path = write_movie(tmp_path / "a.mp4")
    run_ffmpeg("-i", path, "-vf", "setfield=tff", "-field_order", "tt", "-c:v", codec, tmp_path / "a.mov")
    assert read_stream(tmp_path / "a.mov").is_interlaced == is_interlaced


#: FFmpeg's filters to constant luminance of BT.2020, which depends on the transfer function, here not stated.
BT2020_CONSTANT = (
    "setparams=color_primaries=bt2020:color_trc=bt2020-10,zscale=matrixin=gbr:rangein=full:matrix=2020_cl:range=limited,"
    "setparams=color_primaries=unknown:color_trc=unknown"
)


@pytest.mark.parametrize(
    ("code", "lines", "filters", "matrix"),
    [
        ("movie_interlaced", 96, "scale=out_color_matrix=bt601,setfield=tff", ""),
        ("movie_interlaced", 720, "scale=out_color_matrix=bt709,setfield=tff", ""),
        ("movie_form", 96, "zscale=matrixin=gbr:rangein=full:matrix=ycgco:range=limited", "ycgco"),
        ("movie_form", 96, BT2020_CONSTANT, "bt2020c"),
    ],
)
def test_the_advised_line_of_ffmpeg_gives_the_colors_of_the_movie(tmp_path, code, lines, filters, matrix):
    """Of itself FFmpeg takes BT.601 for any matrix that it does not know, and for an untagged movie."""
    picture = next(pictures(1, (128, lines)))
    write_image(tmp_path / "a.png", picture)
    coding = ("-vf", filters, "-pix_fmt", "yuv444p", "-c:v", "ffv1", *(["-colorspace", matrix] if matrix else []))
    run_ffmpeg("-i", tmp_path / "a.png", *coding, tmp_path / "a.mkv")
    problem = refusal_of(PlateError, lambda: check_progressive(read_stream(tmp_path / "a.mkv")))
    assert problem.code == code
    run_ffmpeg(*shlex.split(problem.facts["line"])[1:])
    assert np.abs(read_image(tmp_path / "a.0001.png") - picture / 255).mean() < 0.01


def test_white_of_five_bits_stays_white_by_the_advised_line_of_ffmpeg(tmp_path):
    write_image(tmp_path / "a.png", np.full((96, 128, 3), 255, np.uint8))
    run_ffmpeg("-i", tmp_path / "a.png", "-c:v", "rawvideo", "-pix_fmt", "rgb555le", tmp_path / "a.nut")
    run_ffmpeg(*shlex.split(refusal_of(PlateError, read_stream, tmp_path / "a.nut").facts["line"])[1:])
    assert read_image(tmp_path / "a.0001.png").min() > 0.99


@pytest.mark.parametrize(("codec", "form", "is_named"), [("libvpx-vp9", "yuv420p", True), ("ffv1", "yuva420p", False)])
def test_alpha_that_is_not_decoded_is_named(tmp_path, codec, form, is_named):
    movie = read_stream(write_movie(tmp_path / "a.mkv", codec=codec, form=form, metadata={"alpha_mode": "1"}))
    assert ("its alpha is left out" in str(movie)) == is_named
