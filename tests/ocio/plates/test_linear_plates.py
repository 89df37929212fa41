import re

import numpy as np
import OpenImageIO as oiio
import pytest

from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import Lut1D
from crfnet.luts.rgb_lut import lut_identity
from crfnet.plates.exr import STANDARD_NAMES, linear_header
from tests.helpers.images import write_image
from tests.helpers.plates import LUT, SMALL, attributes, linearize, read_exr

WIDE = np.random.default_rng(1).integers(0, 65536, (70, 90, 3)).astype(np.uint16)


@pytest.mark.parametrize(
    ("name", "codes", "options"),
    [
        *((name, SMALL[..., :3], {}) for name in ("a.jpg", "a.png", "a.tif")),
        *(("gray.png", SMALL[..., :1], {}), ("a16.png", WIDE, {}), ("a16.tif", WIDE, {})),
        *((f"a{bits}.dpx", WIDE, {"oiio__BitsPerSample": bits}) for bits in (10, 12)),
        ("a.webp", SMALL[..., :3], {"Compression": "lossless"}),
        ("encoded.exr", SMALL[..., :3].astype(np.float32) / 200 - 0.1, {}),
        ("alpha.exr", np.sort(SMALL.astype(np.float32) + 1, axis=2) / 256, {}),
        ("alpha.tif", np.sort(SMALL, axis=2), {}),
    ],
)
def test_every_format_gives_what_oiiotool_gives(tmp_path, out, oiiotool, tolerance, name, codes, options):
    plate = write_image(tmp_path / name, codes, **options)
    write_lut(tmp_path / "x.spi1d", LUT)
    linearize(plate, out / "a.exr", LUT, depth="float", is_encoded=True)
    transform = f"--ociofiletransform:unpremult={int(codes.shape[2] == 4)}"
    oiiotool(plate, transform, tmp_path / "x.spi1d", "-d", "float", "-o", tmp_path / "expected.exr")
    expected = read_exr(tmp_path / "expected.exr")[0]
    if codes.shape[2] == 1:
        expected = np.repeat(expected, 3, axis=2)
    # OpenImageIO widens 10 and 12 bits to 16 by repeating bits, so oiiotool may differ by codes of 16 bits.
    atol = 3 / 65535 if "oiio__BitsPerSample" in options else tolerance.plate
    np.testing.assert_allclose(read_exr(out / "a.exr")[0], expected, rtol=0, atol=atol)


def test_unassociated_alpha_is_kept_and_multiplied_in(tmp_path, out):
    plate = write_image(tmp_path / "a.png", SMALL, oiio__UnassociatedAlpha=1)
    linearize(plate, out / "a.exr", LUT, depth="float")
    pixels, spec = read_exr(out / "a.exr")
    alpha = SMALL[..., 3:] / 255
    assert spec.alpha_channel == 3
    np.testing.assert_allclose(pixels[..., 3:], alpha, rtol=1e-6)
    np.testing.assert_allclose(pixels[..., :3], LUT.apply(SMALL[..., :3] / 255) * alpha, rtol=1e-6)


def test_encoded_exr_uses_the_domain_of_the_lut(tmp_path, out):
    lut = Lut1D(np.linspace(-0.25, 2, 10), domain=(-0.125, 1.125))
    values = np.append(np.full((300, 3, 3), 9, np.float32), np.full((302, 3, 3), 0.5, np.float32), axis=0)
    values[-1] = [[-1, -0.125, 0], [1, 1.0625, 9], [-1e9, 0.5, 1.125]]
    linearize(write_image(tmp_path / "a.exr", values), out / "a.exr", lut, depth="float", is_encoded=True)
    pixels, expected = read_exr(out / "a.exr")[0], [[-0.25, -0.25, -0.025], [1.775, 1.8875, 2], [-0.25, 0.875, 2]]
    np.testing.assert_allclose(pixels[-1], expected, atol=1e-6)
    assert pixels[:300].min() == 2


def test_encoded_exr_keeps_its_windows(tmp_path, out):
    gray = np.full((3, 4, 3), 0.5, np.float16)
    plate = write_image(tmp_path / "a.exr", gray, origin=(5, -2), display=(0, 0, 20, 10))
    linearize(plate, out / "a.exr", LUT, is_encoded=True)
    result = read_exr(out / "a.exr")[1]
    assert (result.x, result.y, result.width, result.height) == (5, -2, 4, 3)
    assert (result.full_x, result.full_y, result.full_width, result.full_height) == (0, 0, 20, 10)


def test_metadata_that_remains_true_is_kept(tmp_path, out):
    camera = {"Make": "Canon", "ExposureTime": 0.02, "FNumber": 2.8, "Orientation": 6, "Exif__ColorSpace": 1}
    profile = (oiio.TypeDesc("uint8[8]"), np.arange(8, dtype=np.uint8))
    more = {"ICCProfile": profile, "Software": "a developer", "DateTime": "2001:02:03 04:05:06"}
    linearize(write_image(tmp_path / "a.tif", SMALL[..., :3], **camera, **more), out / "a.exr", LUT)
    result = attributes(read_exr(out / "a.exr")[1])
    assert result["colorInteropID"] == "lin_rec709_scene"
    assert result["crfnet:response"] == "photograph plate.jpg | model test"
    assert (result["Make"], result["Orientation"], result["DateTime"]) == ("Canon", 1, "2001:02:03 04:05:06")
    assert (result["FNumber"], result["ExposureTime"]) == (pytest.approx(2.8), pytest.approx(0.02))
    assert result["crfnet:exposure"] == 0
    assert result["crfnet:lut"] == lut_identity(LUT)
    assert not {"ICCProfile", "Exif:ColorSpace", "Software"} & set(result)


def test_metadata_has_the_names_of_openexr(tmp_path, out):
    exif = {"Exif__LensModel": "EF50mm", "Exif__FocalLength": 50.0, "Exif__PhotographicSensitivity": 200}
    camera = {"Make": "Canon", "Model": "EOS 20D", "ExposureTime": 0.02, "FNumber": 2.8}
    linearize(write_image(tmp_path / "a.jpg", SMALL[..., :3], **exif, **camera), out / "a.exr", LUT, is_encoded=True)
    result = attributes(read_exr(out / "a.exr")[1])
    expected = {"cameraMake": "Canon", "cameraModel": "EOS 20D", "lensModel": "EF50mm"}
    expected |= {"nominalFocalLength": 50.0, "isoSpeed": 200.0}
    assert {name: result.get(name) for name in STANDARD_NAMES} == expected
    content = (out / "a.exr").read_bytes()
    assert all(name.encode() in content for name in (*STANDARD_NAMES, "expTime", "aperture", "Make"))


def test_time_code_and_rate_are_kept(tmp_path, out):
    rate, aspect = (oiio.TypeDesc("rational"), (24000, 1001)), {"PixelAspectRatio": 2.0}
    times = {"smpte__TimeCode": (oiio.TypeDesc("timecode"), (18356486, 7)), "FramesPerSecond": rate}
    plate = write_image(tmp_path / "a.exr", SMALL[..., :3].astype(np.float32) / 255, **times, **aspect)
    linearize(plate, out / "a.exr", LUT, is_encoded=True)
    result, expected = attributes(read_exr(out / "a.exr")[1]), attributes(read_exr(plate)[1])
    assert result["smpte:TimeCode"] == expected["smpte:TimeCode"]
    assert result["FramesPerSecond"] == expected["FramesPerSecond"]
    assert result["PixelAspectRatio"] == 2


@pytest.mark.parametrize(("name", "ratio"), [("a.dpx", 0.0), ("a.png", "1:1")])
def test_a_pixel_aspect_that_openexr_cannot_hold_is_left_out(tmp_path, out, name, ratio):
    """FFmpeg's DPX has 0, and PNG texts of any name."""
    plate = write_image(tmp_path / name, SMALL[..., :3], PixelAspectRatio=ratio, Exif__FocalLength="35 mm")
    linearize(plate, out / "a.exr", LUT)
    assert read_exr(out / "a.exr")[1].getattribute("PixelAspectRatio") in (None, 1)


def test_the_first_of_several_speeds_counts():
    header = oiio.ImageSpec(2, 2, 3, "uint8")
    header.attribute("Exif:PhotographicSensitivity", oiio.TypeDesc("uint[3]"), (100, 200, 2**32 - 1))
    assert linear_header(header, channels=3, depth="half", attributes={}).getattribute("isoSpeed") == 100


def test_output_is_reproducible_and_undated(tmp_path, out):
    plate = write_image(tmp_path / "a.png", SMALL)
    linearize(plate, out / "a.exr", LUT)
    linearize(plate, out / "b.exr", LUT, workers=1)
    assert (out / "a.exr").read_bytes() == (out / "b.exr").read_bytes()
    assert not re.search(rb"\d{4}:\d\d:\d\d", (out / "a.exr").read_bytes()), "a date"
