import wave
from threading import Event

import numpy as np
import pytest

from crfnet.errors import PlateError
from crfnet.movies.frames import WHITE, MovieFrames, decoded
from crfnet.movies.library import is_movie
from crfnet.movies.stream import read_stream
from tests.helpers.folders import written
from tests.helpers.movies import pictures, run_ffmpeg, write_movie
from tests.helpers.plates import LUT, attributes, linearize, read_exr
from tests.helpers.refusals import refusal_of

av = pytest.importorskip("av", reason="needs PyAV: the extra video")

B_FRAMES = {"preset": "fast", "g": "8", "bf": "3"}
INTRA = {"g": "1", "qmin": "1", "qmax": "1"}
LOSS = "log-level=error:crf=2"

#: File, frames and how it is written: codecs and containers that users have, and clocks that trip decoders.
MOVIES = {
    "h264": ("a.mp4", 24, {"options": B_FRAMES}),
    "hevc 10 bits": ("a.mp4", 24, {"codec": "libx265", "form": "yuv420p10le", "options": {"x265-params": LOSS}}),
    "prores": ("a.mov", 6, {"codec": "prores_ks", "form": "yuv422p10le"}),
    "prores 4444": ("a.mov", 6, {"codec": "prores_ks", "form": "yuva444p10le"}),
    "vp9": ("a.webm", 6, {"codec": "libvpx-vp9"}),
    "av1 10 bits": ("a.mkv", 6, {"codec": "libsvtav1", "form": "yuv420p10le"}),
    "motion jpeg": ("a.avi", 6, {"codec": "mjpeg", "form": "yuvj420p", "options": {"qmin": "1", "qmax": "2"}}),
    "mpeg4 in avi": ("a.avi", 12, {"codec": "mpeg4", "options": {"bf": "2", "qmin": "1", "qmax": "2"}}),
    "animation": ("a.mov", 6, {"codec": "qtrle", "form": "rgb24"}),
    "exif in frames": ("a.mov", 6, {"codec": "tiff", "form": "rgb24"}),  # of whose side data PyAV knows nothing
    "uncompressed": ("a.mov", 6, {"codec": "rawvideo", "form": "uyvy422"}),
    "odd size": ("a.mkv", 6, {"codec": "ffv1", "size": (131, 97)}),
    "y4m": ("a.y4m", 6, {"codec": "rawvideo"}),
    "ogg": ("a.ogg", 6, {"codec": "libvpx"}),
    "bare h264": ("a.h264", 24, {"options": B_FRAMES}),
    "bare hevc": ("a.265", 24, {"codec": "libx265", "options": {"x265-params": LOSS}}),
    "transport stream": ("a.ts", 24, {"options": B_FRAMES}),
    "wrapped clock": ("a.ts", 24, {"muxer": {"output_ts_offset": str((2**33 - 30000) / 90000)}}),
    "negative times": ("a.mkv", 24, {"times": range(-12, 12)}),
    "equal times": ("a.mkv", 12, {"codec": "ffv1", "times": [number // 2 for number in range(12)]}),
    "uneven times": ("a.mp4", 12, {"times": [number * number for number in range(12)]}),
    "bare av1": ("a.obu", 6, {"codec": "libsvtav1"}),
    "real media": ("a.rm", 6, {"codec": "rv20", "size": (176, 144), "options": INTRA}),
}


def bars(frames):
    """The number that each frame shows, by the code of the bar at its top; None for a frame that fails."""
    numbers = []
    for load in frames.loaders(range(len(frames.numbers))):
        try:
            numbers.append(round(load().samples[2, 64, 1] / WHITE * 255 / 8))
        except PlateError:
            numbers.append(None)
    return numbers


@pytest.fixture
def movie(tmp_path):
    return write_movie(tmp_path / "clip.mp4", 24, options=B_FRAMES)


@pytest.mark.parametrize("name", MOVIES)
def test_all_frames_are_there_in_order(tmp_path, name):
    file, count, options = MOVIES[name]
    path = write_movie(tmp_path / file, count, **options)
    frames = MovieFrames.find(path)
    assert is_movie(path)
    assert (frames.numbers, bars(frames)) == (tuple(range(1, count + 1)), list(range(1, count + 1)))
    assert frames.movie.bit_depth == {"prores 4444": 12, "prores": 10}.get(name, 10 if "10 bits" in name else 8)
    picture = next(pictures(1, options.get("size", (128, 96)))) / 255
    assert np.abs(next(frames.loaders([0]))().samples / WHITE - picture).mean() < 0.02


def test_theora_is_read(movie, tmp_path):
    """PyAV does not write it."""
    run_ffmpeg("-i", movie, "-c:v", "libtheora", "-q:v", 10, tmp_path / "a.ogv")
    assert is_movie(tmp_path / "a.ogv")
    assert bars(MovieFrames.find(tmp_path / "a.ogv")) == list(range(1, 25))


def copied(movie, target, change, **options):
    """Copy a movie by the packets that `change` returns."""
    with av.open(str(movie)) as old, av.open(str(target), "w", options=options) as new:
        stream = new.add_stream_from_template(old.streams.video[0])
        for packet in change([packet for packet in old.demux(video=0) if packet.size]):
            packet.stream = stream
            new.mux(packet)
    return MovieFrames.find(target)


def test_a_copy_with_the_times_of_decoding_has_all_frames_in_order(movie, tmp_path):
    """As FFmpeg copies AVI and bare streams into MP4, and as some programs write MXF."""

    def change(packets):
        for number, packet in enumerate(packets):
            packet.pts = packet.dts = 512 * number
        return packets

    assert bars(copied(movie, tmp_path / "a.mp4", change)) == [*range(1, 25)]


def test_matroska_that_begins_with_pictures_before_its_first_key_frame_is_counted_without_them(tmp_path):
    """They have times below zero, which it cannot hold, and refer to pictures that a cut has taken away."""

    def change(packets):
        packets = packets[next(number for number, packet in enumerate(packets) if packet.is_keyframe and number) :]
        begin = packets[0].pts
        for packet in packets:
            packet.pts, packet.dts = packet.pts - begin, packet.dts - begin
        return packets

    options = {"x264-params": "open-gop=1:keyint=8:bframes=3:b-adapt=0"}
    path = write_movie(tmp_path / "a.mp4", 24, options=options)
    assert bars(copied(path, tmp_path / "a.mkv", change, avoid_negative_ts="disabled")) == [*range(9, 25)]


@pytest.mark.parametrize("name", ["h264", "hevc 10 bits", "transport stream"])
def test_key_frames_are_decoded_alone(tmp_path, name):
    file, count, options = MOVIES[name]
    options = options | {"options": options["options"] | {"g": "8"}}
    frames = MovieFrames.find(write_movie(tmp_path / file, 3 * count, **options))
    keys = frames.movie.key_numbers
    assert len(keys) >= 2 or name.startswith("hevc")
    everything = dict(frames.photos(frames.numbers))
    for number, photo in frames.photos(keys):
        np.testing.assert_array_equal(photo.pixels, everything[number].pixels)
    assert {number for number, _ in frames.photos(keys)} == set(keys)


def test_frames_are_chosen_and_missing_ones_named(movie):
    frames = MovieFrames.find(movie, "20-30x5,9")
    assert (frames.numbers, frames.missing) == ((9, 20), (25, 30))
    assert bars(frames) == [9, 20]
    assert list(decoded(frames.movie, [])) == []
    assert refusal_of(PlateError, MovieFrames.find, movie, "100").code == "no_such_frames"


def test_a_movie_is_hashed_while_it_is_decoded(movie, tmp_path, monkeypatch):
    begun = Event()
    monkeypatch.setattr("crfnet.plates.frames.file_sha256", lambda _: str(begun.wait(10)))
    linearize(movie, tmp_path / "%d.exr", LUT, frames="3", progress=lambda *_: begun.set())
    assert attributes(read_exr(tmp_path / "3.exr")[1])["crfnet:plate"] == "True 3"


def damage(path, number, start=0.0, end=1.0, *, before=0):
    """Write zeros over a part of a movie's packet, counted from 1 in the order of the file, and bytes before it."""
    with av.open(str(path)) as container:
        packet = [packet for packet in container.demux(video=0) if packet.size][number - 1]
    content = bytearray(path.read_bytes())
    begin, end = (packet.pos + int(packet.size * part) for part in (start, end))
    content[begin - before : end] = bytes(end - begin + before)
    return written(path, content)


#: Frames predicted from the one before, and a key frame every 8.
ROWS = {"options": {"g": "8", "bf": "0", "sc_threshold": "0"}}
HEVC_ROWS = {"codec": "libx265", "options": {"x265-params": "log-level=error:keyint=8:min-keyint=8:bframes=0:crf=10"}}


@pytest.mark.parametrize(
    ("name", "part", "options", "last"),
    [
        ("a.mov", (0, 0.2), {"codec": "prores_ks", "form": "yuv422p10le"}, 11),
        ("a.mkv", (0.4, 0.5), {"codec": "ffv1", "options": {"level": "3", "slicecrc": "1"}}, 12),
        *(("a.mp4", part, ROWS, 16) for part in ((0, 1), (0.5, 0.6))),
        ("a.ts", (0.5, 0.9), ROWS, 16),
        ("a.mp4", (0.3, 0.9), HEVC_ROWS, 16),
        ("a.avi", (0.01, 1), {"codec": "ffv1", "options": {"level": "3", "slicecrc": "1", "g": "1"}}, 11),
    ],
)
def test_damage_fails_up_to_the_next_key_frame_and_the_others_keep_their_numbers(tmp_path, name, part, options, last):
    """Decoders conceal it, predict from a damaged frame, or pass over it, and hardly complain."""
    path = damage(write_movie(tmp_path / name, 24, **options), 11, *part)
    lost = [*range(11, last + 1)]
    assert bars(MovieFrames.find(path)) == [None if number in lost else number for number in range(1, 25)]


@pytest.mark.parametrize(
    ("codec", "options", "head", "last"),
    [
        *[("ffv1", {"g": "1"}, 8, 11), ("mpeg4", {"g": "8", "bf": "0"}, 8, 16)],
        *[("mpeg4", {"g": "8", "bf": "2"}, head, 24) for head in (8, 0)],
    ],
)
def test_an_avi_frame_that_is_not_seen_fails_and_the_others_keep_their_numbers(tmp_path, codec, options, head, last):
    """Its head is damaged, or all but this; FFmpeg leaves out other frames, too, if some refer to later ones."""
    path = write_movie(tmp_path / "a.avi", 24, codec=codec, options={"qmin": "1", "qmax": "1", **options})
    shown = bars(MovieFrames.find(damage(path, 11, end=not head, before=head)))
    assert shown[last:] == [*range(last + 1, 25)]
    assert (shown[:8], shown[10:last], len(shown)) == ([*range(1, 9)], [None] * (last - 10), 24)


def test_a_damaged_first_frame_counts(tmp_path):
    path = damage(write_movie(tmp_path / "a.mov", codec="prores_ks", form="yuv422p10le"), 1)
    assert bars(MovieFrames.find(path)) == [None, 2, 3, 4, 5, 6]


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("a.mkv", {"codec": "ffv1"}),
        ("a.avi", {"codec": "ffvhuff", "form": "rgb24"}),
        ("a.mov", {"codec": "qtrle", "form": "rgb24", "muxer": {"movflags": "faststart"}}),
        ("a.wmv", {"codec": "wmv2", "options": INTRA}),
        ("a.flv", {"codec": "flv", "options": INTRA}),
        ("a.mxf", {"codec": "mpeg2video", "form": "yuv422p", "options": INTRA}),
        ("a.ogv", {"codec": "libvpx", "options": {"g": "1", "crf": "4", "b": "9M"}}),
    ],
)
def test_a_movie_that_is_cut_short_says_so_and_its_last_frame_fails(tmp_path, name, options):
    path = write_movie(tmp_path / name, 24, **options)
    assert "cut short" not in str(read_stream(path))
    frames = MovieFrames.find(written(path, path.read_bytes()[: path.stat().st_size * 2 // 3]))
    shown = bars(frames)
    assert "the file is cut short" in str(frames.movie)
    assert shown[:10] == [*range(1, 11)]
    assert shown[-1] is None


@pytest.mark.parametrize(
    ("index", "place", "reach", "is_cut"),
    [
        *((b"sidx", b"moof", 0, True), (b"sidx", b"mfra", 0, False)),
        *((b"free", b"moof", 4, True), (b"free", b"mdat", 0, True), (b"free", b"mdat", 4, True)),
        (b"free", b"moof", 0, False),  # nothing shows a cut between fragments without an index
    ],
)
def test_fragments_that_a_cut_has_taken_away_are_missed(tmp_path, index, place, reach, is_cut):
    """The cut lies before or within the head of the last box of a kind."""
    muxer = {"movflags": "frag_keyframe+empty_moov+default_base_moof+global_sidx"}
    content = write_movie(tmp_path / "a.mp4", 24, options={"g": "6"}, muxer=muxer).read_bytes()
    assert content.count(b"moof") >= 4
    path = written(tmp_path / "cut.mp4", content[: content.rindex(place) - 4 + reach].replace(b"sidx", index))
    assert ("the file is cut short" in str(read_stream(path))) == is_cut


def test_matroska_that_has_lost_the_place_of_frames_is_refused(tmp_path):
    path = damage(write_movie(tmp_path / "a.mkv", codec="ffv1"), 4, end=0.01, before=20)
    assert refusal_of(PlateError, read_stream, path).code == "movie_undecodable"


REC709 = {"color_range": 1, "colorspace": 1, "color_primaries": 1, "color_trc": 1}

CHANGES = {
    "range": {"tags": REC709 | {"color_range": 2}},
    "interlacing": {"is_interlaced": True},
    "size": {"size": (64, 48)},
    "transfer": {"tags": REC709 | {"color_trc": 16}},
    "primaries": {"tags": REC709 | {"color_primaries": 9}},
}


@pytest.mark.parametrize("change", CHANGES)
def test_a_change_midway_is_refused(tmp_path, change):
    first = {"tags": REC709} if "tags" in CHANGES[change] else {}
    parts = [write_movie(tmp_path / f"{n}.ts", 6, **each) for n, each in enumerate((first, CHANGES[change]))]
    frames = MovieFrames.find(written(tmp_path / "a.ts", b"".join(part.read_bytes() for part in parts)))
    *_, last = frames.loaders(range(12))
    for call in (last, lambda: list(frames.photos(frames.numbers))):
        assert refusal_of(PlateError, call).code == "movie_changes"


@pytest.mark.parametrize(("degrees", "quarters"), [(90, 1), (180, 2), (270, 3)])
def test_frames_are_upright_and_say_so(tmp_path, degrees, quarters):
    movie = {"count": 1, "codec": "qtrle", "form": "rgb24"}
    paths = [write_movie(tmp_path / f"{angle}.mov", **movie, degrees=angle) for angle in (0, degrees)]
    stored, turned = (MovieFrames.find(path) for path in paths)
    assert [next(frames.photos([1]))[1].metadata.is_turned for frames in (stored, turned)] == [False, True]
    frame = next(turned.loaders([0]))()
    assert frame.samples.shape[:2] == turned.movie.picture.size[::-1] == (frame.header.height, frame.header.width)
    np.testing.assert_array_equal(frame.samples, np.rot90(next(stored.loaders([0]))().samples, quarters))


def test_frames_that_are_turned_by_another_angle_are_refused(tmp_path):
    turned = write_movie(tmp_path / "a.mov", count=1, codec="qtrle", form="rgb24", degrees=45)
    assert refusal_of(PlateError, MovieFrames.find, turned).code == "movie_undecodable"


def test_alpha_is_kept(tmp_path):
    path = write_movie(tmp_path / "a.mov", codec="prores_ks", form="yuva444p10le", options={"profile": "4444"})
    frames = MovieFrames.find(path)
    np.testing.assert_allclose(next(frames.loaders([0]))().alpha, 1, atol=0.01)
    assert "does not say how its alpha is meant" in str(frames.movie)


def test_damaged_movies_and_sound_are_refused(movie, tmp_path):
    short = written(tmp_path / "cut short.mp4", movie.read_bytes()[:2000])
    assert refusal_of(PlateError, read_stream, short).code == "movie_undecodable"
    with wave.open(str(tmp_path / "a.wav"), "wb") as file:
        file.setparams((1, 2, 8000, 0, "NONE", ""))
        file.writeframes(bytes(1600))
    assert refusal_of(PlateError, read_stream, tmp_path / "a.wav").code == "no_video"
