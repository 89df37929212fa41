"""Read one frame: encoded EXR files, and everything else as a photograph."""

import struct

import numpy as np
import OpenImageIO as oiio
import pytest

from crfnet.errors import PlateError
from crfnet.plates import frame_files
from crfnet.plates.frame_files import read_color_tags, read_frame
from crfnet_core.colorimetry import DISPLAY_P3
from crfnet_core.errors import PhotoError
from crfnet_core.photograph.metadata.color_tags import ColorTags
from tests.helpers.crafted_files import png, png_chunk
from tests.helpers.images import write_image


def write_exr(path, values, names, **attributes):
    return write_image(path, values.astype(np.float32), names=names, **attributes)


def test_encoded_exr_keeps_its_values(tmp_path):
    values = np.array([[[-0.5, 0.25, 1.5], [0, 1, 2]]])
    frame = read_frame(write_exr(tmp_path / "a.exr", values, ("R", "G", "B")), is_encoded=True)
    assert frame.samples.dtype == np.float32
    assert frame.alpha is None
    np.testing.assert_array_equal(frame.samples, values)


def test_encoded_exr_is_divided_by_its_alpha(tmp_path):
    values = np.array([[[0.25, 0.5, 0, 0.5], [3, 2, 1, 0], [0.1, 0.2, 0.3, 1]]])
    frame = read_frame(write_exr(tmp_path / "a.exr", values, ("R", "G", "B", "A")), is_encoded=True)
    np.testing.assert_allclose(frame.samples, [[[0.5, 1, 0], [0, 0, 0], [0.1, 0.2, 0.3]]], rtol=1e-6)
    np.testing.assert_array_equal(frame.alpha, np.float32([[0.5, 0, 1]]))


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
    with pytest.raises(PlateError) as caught:
        read_frame(path, is_encoded=True)
    assert caught.value.code == "exr_samples"


@pytest.mark.parametrize(
    ("channels", "attributes", "code"),
    [
        (("R", "G", "B"), {"colorInteropID": "lin_ap1_scene"}, "plate_is_linear"),
        (("R", "G"), {}, "exr_channels"),
        (("left.R", "left.G", "left.B"), {}, "exr_channels"),
        (("A",), {}, "exr_channels"),
        (("Z",), {}, "exr_channels"),
        (("mask.R",), {}, "exr_channels"),
    ],
)
def test_other_exr_files_are_refused(tmp_path, channels, attributes, code):
    path = write_exr(tmp_path / "a.exr", np.zeros((1, 1, len(channels))), channels, **attributes)
    with pytest.raises(PlateError) as caught:
        read_frame(path)
    assert (caught.value.code, caught.value.facts["path"]) == (code, path)


@pytest.mark.parametrize("tag", [{}, {"colorInteropID": "unknown"}])
def test_an_untagged_exr_is_refused_unless_it_is_stated_to_be_encoded(tmp_path, tag):
    path = write_exr(tmp_path / "a.exr", np.full((1, 1, 3), 0.5), ("R", "G", "B"), **tag)
    with pytest.raises(PlateError) as caught:
        read_frame(path)
    assert caught.value.code == "exr_untagged"
    np.testing.assert_array_equal(read_frame(path, is_encoded=True).samples, [[[0.5, 0.5, 0.5]]])


def test_an_exr_tagged_as_encoded_is_read(tmp_path):
    path = write_exr(tmp_path / "a.exr", np.full((1, 1, 3), 0.5), ("R", "G", "B"), colorInteropID="srgb_rec709_scene")
    np.testing.assert_array_equal(read_frame(path).samples, [[[0.5, 0.5, 0.5]]])


def test_a_cut_exr_is_refused(tmp_path):
    path = write_exr(tmp_path / "a.exr", np.random.default_rng(0).random((64, 64, 3)), ("R", "G", "B"))
    whole = path.read_bytes()
    for size in (0, 100, len(whole) // 2):
        path.write_bytes(whole[:size])
        with pytest.raises(PlateError) as caught:
            read_frame(path)
        assert str(caught.value).startswith(f"{path}: ")
        assert "\n" not in str(caught.value)
        assert not oiio.geterror()


def test_a_file_tagged_linear_is_refused(tmp_path):
    path = tmp_path / "a.png"
    path.write_bytes(png(1, 1, bytes(4), chunks=png_chunk(b"gAMA", struct.pack(">I", 100_000))))
    with pytest.raises(PhotoError) as caught:
        read_frame(path)
    assert caught.value.code == "tagged_linear"
    assert read_frame(path, is_encoded=True).largest == 255


def test_an_encoded_exr_has_the_primaries_of_its_name(tmp_path):
    pixels = np.full((4, 4, 3), 0.5, np.float32)
    path = write_image(tmp_path / "a.exr", pixels, colorInteropID="srgb_p3d65_scene")
    assert read_frame(path).color == ColorTags(DISPLAY_P3, source="colorInteropID")
    assert read_color_tags(path) == ColorTags(DISPLAY_P3, source="colorInteropID")


def test_the_tags_alone_are_refused_where_the_frame_is(tmp_path):
    pixels = np.full((4, 4, 3), 0.5, np.float32)
    for space, code in (("lin_rec709_scene", "plate_is_linear"), ("", "exr_untagged")):
        path = write_image(tmp_path / "a.exr", pixels, colorInteropID=space)
        for read in (read_frame, read_color_tags):
            with pytest.raises(PlateError) as caught:
                read(path)
            assert caught.value.code == code
    assert read_color_tags(path, is_encoded=True).primaries is None


def test_the_error_of_a_damaged_exr_is_printable(tmp_path):
    path = write_exr(tmp_path / "a.exr", np.zeros((4, 4, 3)), ("R", "G", "B"))
    path.write_bytes(path.read_bytes().replace(b"channels\0chlist\0", b"channels\0chl\xa7\x1bt\0", 1))
    with pytest.raises(PlateError) as caught:
        read_frame(path, is_encoded=True)
    assert str(caught.value).startswith(f"{path}: cannot be read (")
    assert str(caught.value).isprintable()
