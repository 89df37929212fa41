"""linearize_plates: exact values, kept and true metadata, resumption, and nothing half-written."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from crfnet_core.errors import PhotoError, PlateError
from crfnet_core.files import atomic_write
from crfnet_core.image_io import read_codes, read_photo
from crfnet_core.response import ResponseCurve
from ocio.luts.lut1d import Lut1D, inverse_response_lut
from ocio.luts.spi1d import write_spi1d
from ocio.options import PlateOptions
from ocio.plates import exr
from ocio.plates import linear as plates_module
from ocio.plates.frames import find_frames
from ocio.plates.linear import STALE_SECONDS, PlateReport, linear_targets, linearize_plates
from tests.helpers.processes import start_interruptible

ROOT = Path(__file__).parents[2]
LUT = inverse_response_lut(ResponseCurve.gamma(2.2), comments=("photograph plate.jpg", "model test"))
SMALL = np.random.default_rng(0).integers(0, 256, (70, 90, 4), dtype=np.uint8)


def write(path, codes, **attributes):
    """Write `codes` (H, W, C) with OpenImageIO; `__` in an attribute's name stands for a colon."""
    kind = {"float16": "half", "float32": "float"}.get(str(codes.dtype), str(codes.dtype))
    spec = oiio.ImageSpec(codes.shape[1], codes.shape[0], codes.shape[2], kind)
    for name, value in attributes.items():
        words = value if isinstance(value, tuple) else (value,)
        spec.attribute(name.replace("__", ":"), *words)
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), spec), output.geterror()
    assert output.write_image(codes), output.geterror()
    output.close()
    return path


def read(path):
    """Return the pixels of an EXR as float32, and its header."""
    image = oiio.ImageInput.open(str(path))
    spec = image.spec()
    pixels = image.read_image(0, 0, 0, spec.nchannels, "float")
    image.close()
    return pixels, spec


def linearize(plates, out, lut, *, frames=None, workers=None, progress=None, **options):
    """Linearise what `plates` stands for into what `out` stands for."""
    sequence = find_frames(plates, frames)
    targets = linear_targets(out, sequence)
    return linearize_plates(sequence, targets, lut, PlateOptions(**options), workers=workers, progress=progress)


def attributes(spec):
    return {attribute.name: attribute.value for attribute in spec.extra_attribs}


def sequence(folder, numbers, name="plate.{:04d}.png"):
    """Write a frame of its own for every number."""
    for number in numbers:
        write(folder / name.format(number), np.roll(SMALL[..., :3], number, axis=0))
    return folder / "plate.%04d.png"


def listed(folder):
    return sorted(path.name for path in folder.iterdir())


def bytes_of(folder):
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


@pytest.fixture
def out(tmp_path):
    (tmp_path / "out").mkdir()
    return tmp_path / "out"


@pytest.fixture(scope="session")
def oiiotool():
    beside = Path(sys.executable).with_name("oiiotool")
    found = str(beside) if beside.is_file() else shutil.which("oiiotool")
    if not found:
        pytest.skip("oiiotool is not installed")
    return lambda *words: subprocess.run([found, *map(str, words)], check=True, capture_output=True, timeout=60)


def test_8_bit_values(tmp_path, out):
    codes = np.arange(256, dtype=np.uint8).reshape(16, 16, 1).repeat(3, axis=2)
    report = linearize(write(tmp_path / "a.png", codes), out / "a.exr", LUT, depth="float")
    assert report == PlateReport((out / "a.exr",), (), ())
    pixels, spec = read(out / "a.exr")
    assert str(spec.format) == "float"
    assert spec.channelnames == ("R", "G", "B")
    np.testing.assert_array_equal(pixels, LUT.apply(codes / 255).astype(np.float32))
    np.testing.assert_allclose(pixels, (codes / 255) ** 2.2, atol=1e-3)


def test_half_is_the_rounded_float_and_the_default(tmp_path, out):
    linearize(write(tmp_path / "a.png", SMALL[..., :3]), out / "a.exr", LUT)
    pixels, spec = read(out / "a.exr")
    assert str(spec.format) == "half"
    np.testing.assert_array_equal(pixels, LUT.apply(SMALL[..., :3] / 255).astype(np.float16))


@pytest.mark.parametrize("stops", [-2, 1, 0.5])
def test_exposure_in_stops(tmp_path, out, stops):
    path = write(tmp_path / "a.png", SMALL[..., :3])
    linearize(path, out / "a.exr", LUT, depth="float", exposure=stops)
    np.testing.assert_allclose(read(out / "a.exr")[0], LUT.apply(SMALL[..., :3] / 255) * 2**stops, rtol=1e-6)


def test_gray_plate_becomes_rgb(tmp_path, out):
    linearize(write(tmp_path / "a.png", SMALL[..., :1]), out / "a.exr", LUT, depth="float")
    np.testing.assert_array_equal(
        read(out / "a.exr")[0], np.repeat(LUT.apply(SMALL[..., :1] / 255), 3, axis=2).astype("f")
    )


WIDE = np.random.default_rng(1).integers(0, 65536, (70, 90, 3)).astype(np.uint16)


@pytest.mark.parametrize(
    ("name", "codes", "options"),
    [
        ("a.jpg", SMALL[..., :3], {}),
        ("a.png", SMALL[..., :3], {}),
        ("gray.png", SMALL[..., :1], {}),
        ("a16.png", WIDE, {}),
        ("a.tif", SMALL[..., :3], {}),
        ("a16.tif", WIDE, {}),
        ("a10.dpx", WIDE, {"oiio__BitsPerSample": 10}),
        ("a12.dpx", WIDE, {"oiio__BitsPerSample": 12}),
        ("a.webp", SMALL[..., :3], {"Compression": "lossless"}),
        ("encoded.exr", SMALL[..., :3].astype(np.float32) / 200 - 0.1, {}),
        ("alpha.exr", np.sort(SMALL.astype(np.float32) + 1, axis=2) / 256, {}),
    ],
)
def test_equals_oiiotool(tmp_path, out, oiiotool, tolerance, name, codes, options):
    plate = write(tmp_path / name, codes, **options)
    write_spi1d(tmp_path / "x.spi1d", LUT)
    linearize(plate, out / "a.exr", LUT, depth="float")
    transform = f"--ociofiletransform:unpremult={int(codes.shape[2] == 4)}"
    oiiotool(plate, transform, tmp_path / "x.spi1d", "-d", "float", "-o", tmp_path / "expected.exr")
    expected = read(tmp_path / "expected.exr")[0]
    if codes.shape[2] == 1:
        expected = np.repeat(expected, 3, axis=2)
    # 10 and 12 bits reach oiiotool widened to 16 by repeating bits, up to a code of 16 bits from code / 1023
    atol = 3 / 65535 if "oiio__BitsPerSample" in options else tolerance.plate
    np.testing.assert_allclose(read(out / "a.exr")[0], expected, rtol=0, atol=atol)


def test_unassociated_alpha_is_kept_and_multiplied_in(tmp_path, out, oiiotool, tolerance):
    plate = write(tmp_path / "a.png", SMALL, oiio__UnassociatedAlpha=1)
    write_spi1d(tmp_path / "x.spi1d", LUT)
    linearize(plate, out / "a.exr", LUT, depth="float")
    pixels, spec = read(out / "a.exr")
    alpha = SMALL[..., 3:] / 255
    assert spec.alpha_channel == 3
    np.testing.assert_allclose(pixels[..., 3:], alpha, rtol=1e-6)
    np.testing.assert_allclose(pixels[..., :3], LUT.apply(SMALL[..., :3] / 255) * alpha, rtol=1e-6)
    raw = ("--iconfig", "oiio:UnassociatedAlpha", "1", plate, "--ociofiletransform", tmp_path / "x.spi1d", "--premult")
    oiiotool(*raw, "-d", "float", "-o", tmp_path / "expected.exr")
    np.testing.assert_allclose(pixels, read(tmp_path / "expected.exr")[0], rtol=0, atol=tolerance.plate)


def test_associated_alpha_is_divided_out_before_the_lut(tmp_path, out, oiiotool, tolerance):
    codes = np.sort(SMALL, axis=2)
    codes[..., 3] = np.maximum(codes[..., 3], 1)
    plate = write(tmp_path / "a.tif", codes)
    write_spi1d(tmp_path / "x.spi1d", LUT)
    linearize(plate, out / "a.exr", LUT, depth="float", exposure=1)
    alpha = codes[..., 3:] / 255
    pixels = read(out / "a.exr")[0]
    np.testing.assert_allclose(pixels[..., :3], LUT.apply(codes[..., :3] / codes[..., 3:]) * alpha * 2, atol=1e-6)
    np.testing.assert_allclose(pixels[..., 3:], alpha, rtol=1e-6)
    oiiotool(plate, "--ociofiletransform:unpremult=1", tmp_path / "x.spi1d", "-d", "float", "-o", tmp_path / "b.exr")
    np.testing.assert_allclose(pixels[..., :3], read(tmp_path / "b.exr")[0][..., :3] * 2, atol=tolerance.plate)


def test_encoded_exr_uses_the_domain_of_the_lut(tmp_path, out):
    lut = Lut1D(np.linspace(-0.25, 2, 10), domain=(-0.125, 1.125))
    values = np.array([[[-1, -0.125, 0], [1, 1.0625, 9], [np.nan, 0.5, 1.125]]], np.float32)
    linearize(write(tmp_path / "a.exr", values), out / "a.exr", lut, depth="float")
    expected = [[[-0.25, -0.25, -0.025], [1.775, 1.8875, 2], [-0.25, 0.875, 2]]]
    np.testing.assert_allclose(read(out / "a.exr")[0], expected, atol=1e-6)


def test_encoded_exr_keeps_its_windows(tmp_path, out):
    spec = oiio.ImageSpec(4, 3, 3, "half")
    spec.x, spec.y, spec.full_x, spec.full_y, spec.full_width, spec.full_height = 5, -2, 0, 0, 20, 10
    output = oiio.ImageOutput.create(str(tmp_path / "a.exr"))
    assert output.open(str(tmp_path / "a.exr"), spec)
    assert output.write_image(np.full((3, 4, 3), 0.5, np.float16))
    output.close()
    linearize(tmp_path / "a.exr", out / "a.exr", LUT)
    found = read(out / "a.exr")[1]
    assert (found.x, found.y, found.width, found.height) == (5, -2, 4, 3)
    assert (found.full_x, found.full_y, found.full_width, found.full_height) == (0, 0, 20, 10)


def test_our_own_output_is_refused_as_a_plate(tmp_path, out):
    linearize(write(tmp_path / "a.png", SMALL[..., :3]), out / "a.exr", LUT)
    with pytest.raises(
        PlateError, match=r"a\.exr: is scene-linear already \(lin_rec709_scene\); give the encoded plate"
    ):
        linearize(out / "a.exr", out / "b.exr", LUT)
    assert not (out / "b.exr").exists()


def test_metadata_that_remains_true_is_kept(tmp_path, out):
    plate = write(
        tmp_path / "a.tif",
        SMALL[..., :3],
        Make="Canon",
        ExposureTime=0.02,
        FNumber=2.8,
        Orientation=6,
        Exif__ColorSpace=1,
        ICCProfile=(oiio.TypeDesc("uint8[8]"), np.arange(8, dtype=np.uint8)),
        Software="a developer",
        DateTime="2001:02:03 04:05:06",
    )
    linearize(plate, out / "a.exr", LUT)
    found = attributes(read(out / "a.exr")[1])
    assert found["compression"] == "zips"
    assert found["colorInteropID"] == "lin_rec709_scene"
    assert found["crfnet:response"] == "photograph plate.jpg | model test"
    assert (found["Make"], found["Orientation"], found["DateTime"]) == ("Canon", 6, "2001:02:03 04:05:06")
    assert found["FNumber"] == pytest.approx(2.8)
    assert found["ExposureTime"] == pytest.approx(0.02)
    assert not {"ICCProfile", "Exif:ColorSpace", "Software"} & set(found)


def test_time_code_and_rate_are_kept(tmp_path, out):
    plate = write(
        tmp_path / "a.exr",
        SMALL[..., :3].astype(np.float32) / 255,
        smpte__TimeCode=(oiio.TypeDesc("timecode"), (18356486, 7)),
        FramesPerSecond=(oiio.TypeDesc("rational"), (24000, 1001)),
        PixelAspectRatio=2.0,
    )
    linearize(plate, out / "a.exr", LUT)
    found, expected = attributes(read(out / "a.exr")[1]), attributes(read(plate)[1])
    assert found["smpte:TimeCode"] == expected["smpte:TimeCode"]
    assert found["FramesPerSecond"] == expected["FramesPerSecond"]
    assert found["PixelAspectRatio"] == 2


def test_output_is_reproducible_and_undated(tmp_path, out):
    plate = write(tmp_path / "a.png", SMALL)
    linearize(plate, out / "a.exr", LUT)
    linearize(plate, out / "b.exr", LUT, workers=1)
    assert (out / "a.exr").read_bytes() == (out / "b.exr").read_bytes()
    assert not re.search(rb"\d{4}:\d\d:\d\d", (out / "a.exr").read_bytes()), "a date"


def test_sequence(tmp_path, out):
    pattern = sequence(tmp_path, (1, 2, 4, 7))
    calls = []
    report = linearize(pattern, out / "lin_###.exr", LUT, progress=lambda *call: calls.append(call))
    assert [path.name for path in report.written] == ["lin_001.exr", "lin_002.exr", "lin_004.exr", "lin_007.exr"]
    assert (report.skipped, report.missing) == ((), (3, 5, 6))
    assert calls == [(0, 4), (1, 4), (2, 4), (3, 4), (4, 4)]
    assert listed(out) == [path.name for path in report.written]
    for number, path in zip((1, 2, 4, 7), report.written, strict=True):
        expected = LUT.apply(read_photo(tmp_path / f"plate.{number:04d}.png").pixels).astype(np.float16)
        np.testing.assert_array_equal(read(path)[0], expected)


def test_some_frames_of_a_sequence(tmp_path, out):
    pattern = sequence(tmp_path, range(1, 7))
    report = linearize(str(pattern), str(out / "a.%d.exr"), LUT, frames="2-8x2")
    assert [path.name for path in report.written] == ["a.2.exr", "a.4.exr", "a.6.exr"]
    assert report.missing == (8,)


@pytest.mark.parametrize("workers", [1, 2, 7])
def test_workers_change_nothing(tmp_path, out, workers):
    pattern = sequence(tmp_path, range(5))
    linearize(pattern, out / "a.%d.exr", LUT, workers=workers)
    expected = tmp_path / "expected"
    expected.mkdir()
    linearize(pattern, expected / "a.%d.exr", LUT)
    assert bytes_of(out) == bytes_of(expected)


def test_finished_frames_are_left_alone(tmp_path, out):
    pattern = sequence(tmp_path, range(4))
    linearize(pattern, out / "a.%d.exr", LUT)
    complete = bytes_of(out)
    (out / "a.2.exr").unlink()
    (out / "a.3.exr").write_bytes(b"finished elsewhere")
    calls = []
    report = linearize(pattern, out / "a.%d.exr", LUT, progress=lambda *call: calls.append(call))
    assert report.written == (out / "a.2.exr",)
    assert report.skipped == (out / "a.0.exr", out / "a.1.exr", out / "a.3.exr")
    assert calls == [(3, 4), (4, 4)]
    assert bytes_of(out) == complete | {"a.3.exr": b"finished elsewhere"}


def test_overwrite_writes_everything_again(tmp_path, out):
    pattern = sequence(tmp_path, range(3))
    (out / "a.1.exr").write_bytes(b"old")
    report = linearize(pattern, out / "a.%d.exr", LUT, overwrite=True)
    assert (len(report.written), report.skipped) == (3, ())
    assert read(out / "a.1.exr")[0].shape == (70, 90, 3)


def test_bad_frames_are_named_and_the_others_written(tmp_path, out):
    pattern = sequence(tmp_path, range(1, 6))
    for number in (2, 3):
        whole = (tmp_path / f"plate.{number:04d}.png").read_bytes()
        (tmp_path / f"plate.{number:04d}.png").write_bytes(whole[: len(whole) // 2])
    calls = []
    with pytest.raises(PlateError) as caught:
        linearize(pattern, out / "a.%d.exr", LUT, progress=lambda *call: calls.append(call))
    message = str(caught.value)
    assert message.startswith("2 of 5 frames failed (2-3) and the others are written; the first: ")
    assert "plate.0002.png: this PNG file is damaged or cut short" in message
    assert "\n" not in message
    assert listed(out) == ["a.1.exr", "a.4.exr", "a.5.exr"]
    assert calls[-1] == (5, 5)
    sequence(tmp_path, (2, 3))
    assert len(linearize(pattern, out / "a.%d.exr", LUT).written) == 2


def test_bad_single_plate_gives_its_own_message(tmp_path, out):
    (tmp_path / "a.png").touch()
    with pytest.raises(PlateError, match=r"a\.png: the file is empty; copy it again$"):
        linearize(tmp_path / "a.png", out / "a.exr", LUT)
    assert bytes_of(out) == {}


def test_scene_linear_float_plates_are_refused(tmp_path, out):
    write(tmp_path / "a.tif", SMALL[..., :3].astype(np.float32))
    with pytest.raises(PlateError, match="float samples holds scene-linear values"):
        linearize(tmp_path / "a.tif", out / "a.exr", LUT)
    with pytest.raises(PhotoError):
        read_codes(tmp_path / "a.tif")


@pytest.mark.parametrize(
    ("target", "message"),
    [
        ("out/a.exr", "one name for 2 frames; put their number into it, as in plate.%04d.exr"),
        ("out/a.%04d.png", r"linear plates are OpenEXR; give a name that ends in \.exr"),
        ("out/a", "linear plates are OpenEXR"),
        ("absent/a.####.exr", "the folder .*absent does not exist; create it first"),
        ("out/a.##.##.exr", "holds 2 frame placeholders"),
    ],
)
def test_output_names_that_cannot_be(tmp_path, out, target, message):
    with pytest.raises(PlateError, match=message) as caught:
        linearize(sequence(tmp_path, (1, 2)), tmp_path / target, LUT)
    assert "\n" not in str(caught.value)
    assert bytes_of(out) == {}


@pytest.mark.parametrize(
    ("plate", "target"), [("a.exr", "a.exr"), ("a.#.exr", "a.%04d.exr"), ("a.#.exr", "./b/../a.@.exr")]
)
def test_plates_are_never_replaced(tmp_path, plate, target):
    values = SMALL[..., :3].astype(np.float32) / 255
    (tmp_path / "b").mkdir()
    for name in ("a.exr", "a.0001.exr", "a.1001.exr"):
        write(tmp_path / name, values)
    before = {name: (tmp_path / name).read_bytes() for name in listed(tmp_path) if name != "b"}
    with pytest.raises(PlateError, match="is one of the plates, which are never replaced; choose another name"):
        linearize(tmp_path / plate, f"{tmp_path}/{target}", LUT, overwrite=True)
    assert {name: (tmp_path / name).read_bytes() for name in listed(tmp_path) if name != "b"} == before


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"depth": "double"}, "depth 'double' is unknown; choose half or float"),
        ({"exposure": float("nan")}, "an exposure of nan stops is out of range"),
        ({"exposure": float("inf")}, "an exposure of inf stops is out of range"),
        ({"exposure": 5000}, "an exposure of 5000 stops is out of range"),
        ({"exposure": -5000}, "an exposure of -5000 stops is out of range"),
        ({"exposure": 17}, "values up to 131072 do not fit into half floats; ask for float"),
        ({"workers": 0}, "0 workers cannot work; give 1 or more"),
        ({"frames": "1-3"}, "is a single file, which has no frames"),
    ],
)
def test_options_out_of_range(tmp_path, out, options, message):
    plate = write(tmp_path / "a.png", SMALL[..., :3])
    with pytest.raises(PlateError, match=message):
        linearize(plate, out / "a.exr", LUT, **options)
    assert bytes_of(out) == {}


def test_great_exposures_fit_into_floats(tmp_path, out):
    linearize(write(tmp_path / "a.png", SMALL[..., :3]), out / "a.exr", LUT, exposure=17, depth="float")
    assert np.isfinite(read(out / "a.exr")[0]).all()


def test_failed_write_leaves_nothing(tmp_path, out, monkeypatch):
    def fail(path, header, pixels, *, name):
        path.write_bytes(b"half an EXR")
        raise PlateError(f"{name}: cannot be written (disk full); check the disk")

    monkeypatch.setattr(plates_module, "write_exr", fail)
    with pytest.raises(PlateError, match=r"out/a\.exr: cannot be written"):
        linearize(write(tmp_path / "a.png", SMALL), out / "a.exr", LUT)
    assert bytes_of(out) == {}


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs the device that is always full")
def test_full_disk(tmp_path):
    (tmp_path / "full.exr").symlink_to("/dev/full")
    spec = oiio.ImageSpec(90, 70, 4, "half")
    with pytest.raises(PlateError, match=r"a\.exr: cannot be written \(.*\); check the disk") as caught:
        exr.write_exr(tmp_path / "full.exr", spec, SMALL.astype(np.float16), name=Path("a.exr"))
    assert "\n" not in str(caught.value)


def test_old_leftovers_of_these_frames_are_removed(tmp_path, out):
    pattern = sequence(tmp_path, (1, 2))
    old = time.time() - STALE_SECONDS - 60
    with atomic_write(out / "a.0001.exr") as temporary:
        assert plates_module._LEFTOVER.fullmatch(temporary.name)
        names = [temporary.name, ".b.0001.abcdefgh.exr", ".a.0009.abcdefgh.exr", ".a.0001.exr", "a.0001.abcdefgh.exr"]
    (out / "a.0001.exr").unlink()
    for name in [*names, ".a.0002.abcdefgh.exr"]:
        (out / name).touch()
    for name in names:
        os.utime(out / name, (old, old))
    linearize(pattern, out / "a.####.exr", LUT)
    expected = {*names[1:], ".a.0002.abcdefgh.exr", "a.0001.exr", "a.0002.exr"}
    assert set(listed(out)) == expected, "only what is old and belongs to a frame of this run goes"


RUN = """
import sys
from ocio.luts.lut1d import Lut1D
from ocio.options import PlateOptions
from ocio.plates.frames import find_frames
from ocio.plates.linear import linear_targets, linearize_plates
sequence = find_frames(sys.argv[1])
targets = linear_targets(sys.argv[2], sequence)
lut, options = Lut1D([0, 0.2, 1]), PlateOptions(depth="float")
linearize_plates(sequence, targets, lut, options, progress=lambda *_: print(flush=True))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
@pytest.mark.parametrize("stop", [signal.SIGKILL, signal.SIGINT])
def test_interrupted_run_leaves_whole_frames_and_is_resumed(tmp_path, out, stop):
    total = 24
    large = np.tile(SMALL[..., :3], (10, 8, 1))
    write(tmp_path / "plate.0000.png", large, png__compressionLevel=1)
    for number in range(1, total):
        shutil.copy(tmp_path / "plate.0000.png", tmp_path / f"plate.{number:04d}.png")
    arguments = [sys.executable, "-c", RUN, tmp_path / "plate.%04d.png", out / "a.%d.exr"]
    process = start_interruptible(arguments, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    for _ in range(3):
        assert process.stdout.readline()
    process.send_signal(stop)
    process.stdout.close()
    assert process.wait(timeout=30) != 0
    finished = [path for path in out.iterdir() if not path.name.startswith(".")]
    assert 2 <= len(finished) < total
    if stop == signal.SIGINT:
        assert len(finished) == len(listed(out))
    lut = Lut1D([0, 0.2, 1])
    expected = lut.apply(large / 255).astype(np.float32)
    for path in finished:
        np.testing.assert_array_equal(read(path)[0], expected)
    report = linearize(tmp_path / "plate.%04d.png", out / "a.%d.exr", lut, depth="float")
    assert set(report.skipped) == set(finished)
    assert len(report.written) == total - len(finished)
    np.testing.assert_array_equal(read(report.written[-1])[0], expected)


def test_failing_callback_stops_the_run_cleanly(tmp_path, out):
    def stop(done, total):
        if done == 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        linearize(sequence(tmp_path, range(40)), out / "a.%d.exr", LUT, workers=1, progress=stop)
    names = listed(out)
    assert 1 <= len(names) < 40
    assert not any(name.startswith(".") for name in names)


def test_arguments_stay_as_they_were(tmp_path, out):
    before = LUT.values.copy()
    plate = write(tmp_path / "a.png", SMALL)
    content = plate.read_bytes()
    linearize(plate, out / "a.exr", LUT, exposure=2)
    np.testing.assert_array_equal(LUT.values, before)
    assert plate.read_bytes() == content
    assert listed(tmp_path) == ["a.png", "out"]
