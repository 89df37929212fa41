from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from crfnet.errors import PlateError
from crfnet.pipeline.photographs import unreadable_reason
from crfnet.plates import frame_files
from crfnet.plates.exr import linear_header
from crfnet.plates.frame_files import read_color_tags, read_frame
from crfnet_core.colorimetry import DISPLAY_P3
from crfnet_core.errors import CRFNetError
from crfnet_core.photograph.metadata.color_tags import ColorTags
from tests.helpers.folders import changed, written
from tests.helpers.images import write_image
from tests.helpers.refusals import refusal_of, refused


def write_exr(path, values, names, **attributes):
    return write_image(path, values.astype(np.float32), names=names, **attributes)


def test_encoded_exr_is_divided_by_its_alpha(tmp_path):
    values = np.array([[[0.25, 0.5, 0, 0.5], [3, 2, 1, 0], [0.1, 0.2, 0.3, 1]]])
    frame = read_frame(write_exr(tmp_path / "a.exr", values, ("R", "G", "B", "A")), is_encoded=True)
    np.testing.assert_allclose(frame.samples, [[[0.5, 1, 0], [0, 0, 0], [0.1, 0.2, 0.3]]], rtol=1e-6)
    np.testing.assert_array_equal(frame.alpha, np.float32([[0.5, 0, 1]]))


def test_the_alpha_of_another_layer_is_not_that_of_the_picture(tmp_path):
    """OpenImageIO takes it for alpha; a matte would blacken the plate."""
    values = np.array([[[0.25, 0.5, 0.75, 0.0]]])
    frame = read_frame(write_exr(tmp_path / "a.exr", values, ("R", "G", "B", "mask.A")), is_encoded=True)
    np.testing.assert_array_equal(frame.samples, np.float32(values[..., :3]))
    assert frame.alpha is None


@pytest.mark.parametrize("channels", [("Y",), ("R",), ("Y", "A")])
def test_gray_encoded_exr_is_replicated(tmp_path, channels):
    values = np.array([[[0.25, 1.0][: len(channels)]]])
    frame = read_frame(write_exr(tmp_path / "a.exr", values, channels), is_encoded=True)
    np.testing.assert_array_equal(frame.samples, [[[0.25] * 3]])


def test_an_exr_of_many_large_channels_is_refused(tmp_path, monkeypatch):
    """All of them are decompressed to read three."""
    path = write_exr(tmp_path / "a.exr", np.zeros((10, 10, 41)), ("R", "G", "B", *map(str, range(38))))
    monkeypatch.setattr(frame_files, "MAX_PIXELS", 1100)
    assert read_frame(path, is_encoded=True).samples.shape == (10, 10, 3)
    monkeypatch.setattr(frame_files, "MAX_PIXELS", 1000)
    assert refusal_of(PlateError, read_frame, path, is_encoded=True).code == "exr_samples"


@pytest.mark.parametrize(
    "channels", [("R", "G"), ("left.R", "left.G", "left.B"), ("A",), ("Z",), ("mask.R",)], ids="".join
)
def test_an_exr_without_colors_is_refused(tmp_path, channels):
    path = write_exr(tmp_path / "a.exr", np.zeros((1, 1, len(channels))), channels)
    with refused(PlateError, "exr_channels", path=path):
        read_frame(path)


@pytest.mark.parametrize(
    ("space", "code"),
    [("lin_rec709_scene", "plate_is_linear"), *((name, "exr_untagged") for name in ("", "unknown", "ACEScg", "g22"))],
)
@pytest.mark.parametrize("read", [read_frame, read_color_tags])
def test_an_exr_whose_tag_does_not_say_that_it_is_encoded_is_refused(tmp_path, read, space, code):
    path = write_exr(tmp_path / "a.exr", np.full((1, 1, 3), 0.5), ("R", "G", "B"), colorInteropID=space)
    with refused(PlateError, code, path=path):
        read(path)
    if not space:
        np.testing.assert_array_equal(read_frame(path, is_encoded=True).samples, [[[0.5, 0.5, 0.5]]])
        assert read_color_tags(path, is_encoded=True).primaries is None


@pytest.mark.parametrize("first", [("Z",), ("Y",), ("X", "Y", "Z")])
def test_the_first_part_with_colors_is_read(tmp_path, oiiotool, first):
    """Depth, a mask or normals may come before it."""
    values = np.random.default_rng(0).random((3, 4, 3), np.float32)
    parts = [write_exr(tmp_path / "first.exr", np.full((3, 4, len(first)), 7), first)]
    parts.append(write_exr(tmp_path / "colors.exr", values, ("R", "G", "B")))
    path = tmp_path / "a.exr"
    oiiotool(*parts, "--siappend", "-o", path)
    assert oiio.ImageBuf(str(path)).nsubimages == 2
    np.testing.assert_array_equal(read_frame(path, is_encoded=True).samples, values)


def test_an_exr_with_names_that_are_not_utf8(tmp_path):
    path = write_exr(tmp_path / "a.exr", np.full((4, 4, 4), 0.5), ("R", "G", "B", "l_ft.Z"), multiView="l_ft_right")
    changed(path, b"multiView\0string\0\x0a\0\0\0", b"multiView\0stringvector\0\x0e\0\0\0\x0a\0\0\0")
    header = read_frame(written(path, path.read_bytes().replace(b"l_ft", b"l\xe4ft")), is_encoded=True).header
    assert linear_header(header, channels=3, depth="half", attributes={}).nchannels == 3


@pytest.mark.parametrize(("depth", "code"), [("uint", "exr_channels"), ("float", "exr_codes")])
def test_an_exr_of_code_values_is_refused(tmp_path, depth, code):
    values = np.full((2, 2, 3), 128, np.uint32 if depth == "uint" else np.float32)
    path = write_image(tmp_path / "a.exr", values, names="RGB", depth=depth)
    with refused(PlateError, code, path=path):
        read_frame(path, is_encoded=True)


@pytest.mark.parametrize("channel", range(4))
def test_an_exr_with_values_that_are_not_finite_is_refused(tmp_path, channel):
    values = np.full((4, 4, 4), 0.5, np.float32)
    values[0, :2, channel], values[1, 1], values[2, 2, 3] = (np.nan, np.inf), -np.inf, 0
    path = write_image(tmp_path / "a.exr", values)
    with refused(PlateError, "exr_not_finite", path=path, count=3):
        read_frame(path, is_encoded=True)


@pytest.mark.skipif(not Path("/dev/null").exists(), reason="needs a device")
@pytest.mark.parametrize(("name", "code"), [("a.exr", "not_a_file"), ("a.png", "not_a_file")])
def test_devices_are_not_opened(tmp_path, name, code):
    """Nor pipes, which would block."""
    (tmp_path / name).symlink_to("/dev/null")
    with refused(CRFNetError, code, path=tmp_path / name):
        read_frame(tmp_path / name, is_encoded=True)
    assert "device" in unreadable_reason(tmp_path / name)


def test_an_exr_that_is_tagged_as_encoded_has_the_primaries_of_the_tag(tmp_path):
    path = write_exr(tmp_path / "a.exr", np.full((1, 1, 3), 0.5), ("R", "G", "B"), colorInteropID="pq_p3d65_display")
    np.testing.assert_array_equal(read_frame(path).samples, [[[0.5, 0.5, 0.5]]])
    expected = ColorTags(DISPLAY_P3, "PQ", "colorInteropID", "colorInteropID")
    assert read_frame(path).color == read_color_tags(path) == expected


def test_an_exr_with_a_damaged_header_is_refused(tmp_path):
    path = write_exr(tmp_path / "a.exr", np.zeros((4, 4, 3)), ("R", "G", "B"))
    changed(path, b"channels\0chlist\0", b"channels\0chl\xa7\x1bt\0")
    with refused(PlateError, "exr_unreadable", path=path):
        read_frame(path, is_encoded=True)
