import numpy as np
import pytest

from crfnet_core.photograph.yuv import MATRICES, Coding, alpha_of, bit_depth, rgb_codes

av = pytest.importorskip("av", reason="needs PyAV: the extra video")

#: Random RGB, shape (H, W, 3), in [0, 1].
RGB = np.random.default_rng(0).random((32, 64, 3))


def frame_of(form, *planes, width=None):
    """A frame with samples in its planes, given as arrays of whole numbers, shape (h, w)."""
    frame = av.VideoFrame(width or planes[0].shape[1], planes[0].shape[0], form)
    for plane, samples in zip(frame.planes, planes, strict=True):
        kind = np.uint8 if not form.endswith("le") else "<u2"
        lines = np.zeros((plane.height, plane.line_size // np.dtype(kind).itemsize), kind)
        lines[:, : samples.shape[1]] = samples
        plane.update(lines.tobytes())
    return frame


def yuv_of(rgb, matrix, bits, is_full):
    """Luma and chroma by H.273, equations 8.3 to 8.5, rounded."""
    _, red, blue = MATRICES[matrix]
    luma = rgb @ (red, 1 - red - blue, blue)
    chroma = (rgb[..., 2] - luma) / (2 - 2 * blue), (rgb[..., 0] - luma) / (2 - 2 * red)
    scale, white = 2 ** (bits - 8), 2**bits - 1
    if is_full:
        return [np.rint(luma * white), *(np.clip(np.rint(each * white + 128 * scale), 0, white) for each in chroma)]
    return [np.rint((219 * luma + 16) * scale), *(np.rint((224 * each + 128) * scale) for each in chroma)]


@pytest.mark.parametrize("matrix", MATRICES)
@pytest.mark.parametrize("is_full", [False, True])
@pytest.mark.parametrize("bits", [8, 10, 12])
def test_rgb_comes_back(matrix, is_full, bits):
    frame = frame_of("yuv444p" if bits == 8 else f"yuv444p{bits}le", *yuv_of(RGB, matrix, bits, is_full))
    frame.colorspace, frame.color_range = matrix, 2 if is_full else 1
    coding = Coding.from_frame(frame, is_still=False)
    assert (coding.matrix, coding.is_full_range, bit_depth(frame)) == (MATRICES[matrix][0], is_full, bits)
    assert np.abs(rgb_codes(frame, coding, 65535) / 65535 - RGB).max() < 2.2 / 2**bits


@pytest.mark.parametrize(("form", "width"), [("yuv422p", 64), ("yuv420p", 64), ("yuv420p", 63), ("yuv444p", 63)])
@pytest.mark.parametrize("is_still", [False, True])
def test_chroma_is_interpolated_at_its_place(form, width, is_still):
    ratio = 1 if "444" in form else 2
    columns = -(-width // ratio)
    chroma = np.tile(100 + np.arange(columns), (16 if "420" in form else 32, 1))
    frame = frame_of(form, np.full((32, width), 128), chroma, np.full_like(chroma, 128))
    frame.colorspace, frame.color_range = 1, 2
    coding = Coding.from_frame(frame, is_still=is_still)
    blue = rgb_codes(frame, coding, 65535)[..., 2] / 65535 * 255
    places = (np.arange(width) - (0.5 if is_still and ratio == 2 else 0)) / ratio
    expected = 128 + 2 * (1 - 0.0722) * (100 + np.clip(places, 0, columns - 1) - 128)
    np.testing.assert_allclose(blue, np.tile(expected, (32, 1)), atol=0.01)


LAYOUTS = ["nv12", "p010le", "uyvy422", "yuyv422", "yuv411p", "rgb24", "bgra", "gbrp10le", "rgb48be", "y210le"]


@pytest.mark.parametrize("form", LAYOUTS)
def test_a_color_in_every_layout(form):
    codes = np.full((16, 32, 3), (200, 100, 50), np.uint8)
    frame = av.VideoFrame.from_ndarray(codes, format="rgb24").reformat(format=form, dst_colorspace=1, dst_color_range=1)
    frame.colorspace, frame.color_range = (0, 2) if frame.format.is_rgb else (1, 1)
    coding = Coding.from_frame(frame, is_still=False)
    assert np.abs(rgb_codes(frame, coding, 255).astype(int) - codes).max() <= 2


@pytest.mark.parametrize("form", ["gray", "gray10le", "ya8"])
@pytest.mark.parametrize(("color_range", "is_full"), [(0, True), (1, False), (2, True)])
def test_gray_has_full_range_unless_it_is_tagged(form, color_range, is_full):
    scale = 4 if "10" in form else 1
    ramp = np.tile(np.arange(256) * scale, (4, 1))
    samples = np.stack([ramp, np.full_like(ramp, 200)], 2).reshape(4, 512) if form == "ya8" else ramp
    frame = frame_of(form, samples, width=256)
    if form == "ya8":
        np.testing.assert_allclose(alpha_of(frame), 200 / 255, atol=1e-6)
    frame.color_range = color_range
    coding = Coding.from_frame(frame, is_still=False)
    white = 255 * scale + scale - 1
    expected = ramp[0] / white if is_full else np.clip((ramp[0] / scale - 16) / 219, 0, 1)
    codes = rgb_codes(frame, coding, 65535)[0] / 65535
    np.testing.assert_allclose(codes, np.repeat(expected[:, None], 3, 1), atol=1e-4)
    assert any("range" in each for each in coding.assumptions) == (color_range == 0)


@pytest.mark.parametrize("form", ["gbrp", "gbrp10le", "rgb24"])
def test_rgb_has_limited_range_where_it_is_tagged(form):
    scale = 4 if "10" in form else 1
    ramp = np.tile(np.arange(256) * scale, (4, 1))
    frame = frame_of(form, *([np.repeat(ramp, 3, 1)] if form == "rgb24" else [ramp] * 3), width=256)
    frame.color_range = 1
    codes = rgb_codes(frame, Coding.from_frame(frame, is_still=False), 65535)[0] / 65535
    np.testing.assert_allclose(codes, np.repeat(np.clip((ramp[:1].T / scale - 16) / 219, 0, 1), 3, 1), atol=1e-4)


def test_alpha_of_four_planes():
    planes = [np.full((8, 8), code) for code in (100, 512, 512, 341)]
    np.testing.assert_allclose(alpha_of(frame_of("yuva444p10le", *planes)), 341 / 1023, atol=1e-6)
    assert alpha_of(frame_of("yuv444p10le", *planes[:3])) is None


@pytest.mark.parametrize(("lines", "matrix"), [(718, "BT.601"), (720, "BT.709")])
def test_untagged_video_follows_its_lines_and_untagged_stills_are_bt601_in_full_range(lines, matrix):
    frame = av.VideoFrame(64, lines, "yuv420p")
    video, still = (Coding.from_frame(frame, is_still=is_still) for is_still in (False, True))
    assert (video.matrix, video.is_full_range, len(video.assumptions)) == (matrix, False, 2)
    assert (still.matrix, still.is_full_range, still.assumptions) == ("BT.601", True, ())


def test_the_container_overrides_the_frame():
    frame = av.VideoFrame(64, 64, "yuv420p")
    frame.colorspace, frame.color_range = 1, 1
    coding = Coding.from_frame(frame, is_still=True, codes=(9, 2))
    assert (coding.matrix, coding.is_full_range) == ("BT.2020", True)


@pytest.mark.parametrize(("form", "matrix"), [("yuv444p", 8), ("monow", 2), ("grayf32le", 2), ("xyz12le", 2)])
def test_other_matrices_and_samples_are_not_read(form, matrix):
    frame = av.VideoFrame(64, 64, form)
    frame.colorspace = matrix
    assert Coding.from_frame(frame, is_still=False) is None
