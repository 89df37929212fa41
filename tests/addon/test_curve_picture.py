"""The picture of a response, pixel by pixel."""

import numpy as np
import pytest

from blender_addon.work.curve_picture import (
    BACKGROUND,
    BAND,
    BELOW,
    CODES,
    CURVE,
    HEIGHT,
    LEFT,
    NUMBER,
    SIZE,
    STOPS,
    WIDTH,
    draw_response,
)

UNIFORM = np.linspace(0, 1, 1024)


@pytest.fixture(scope="module")
def picture():
    response = np.sqrt(UNIFORM)
    return draw_response(response, np.clip(response - 0.1, 0, 1), response)


def column(stops):
    """The column of so many stops relative to white, from -8 at the left to 0 at the right."""
    return round(LEFT + (stops + 8) / 8 * WIDTH)


def row(brightness):
    return round(BELOW + brightness * HEIGHT)


def test_it_is_an_image_as_blender_stores_it(picture):
    assert picture.shape == (SIZE, SIZE, 4)
    assert picture.dtype == np.float32
    assert (picture[..., 3] == 1).all()
    assert ((picture >= 0) & (picture <= 1)).all()


def test_the_margin_is_empty(picture):
    for margin in (picture[SIZE - 5 :], picture[:, SIZE - 5 :], picture[:5], picture[:, :2]):
        np.testing.assert_allclose(margin[..., :3], np.broadcast_to(BACKGROUND, margin[..., :3].shape), atol=1e-6)


@pytest.mark.parametrize("stops", [-6.5, -4, -2.5, -1])
def test_the_curve_goes_through_the_responses_values(picture, stops):
    """The square root of light halves its stops."""
    np.testing.assert_allclose(picture[row(2 ** (stops / 2)), column(stops), :3], CURVE, atol=1e-6)


def test_the_band_is_below_the_curve_here(picture):
    brightness = 2 ** (-2.5 / 2)
    np.testing.assert_allclose(picture[row(brightness - 0.05), column(-2.5), :3], BAND, atol=1e-6)
    np.testing.assert_allclose(picture[row(brightness - 0.15), column(-2.5), :3], BACKGROUND, atol=1e-6)
    np.testing.assert_allclose(picture[row(0.98), column(-2.5), :3], BACKGROUND, atol=1e-6)


def test_the_axes_have_their_numbers(picture):
    """Light below the axis, codes at its left; each number is in its place."""
    is_number = (np.abs(picture[..., :3] - NUMBER) < 1e-6).all(axis=2)
    for stops in STOPS:
        assert is_number[:BELOW, column(stops) - 12 : column(stops) + 12].any()
    for code in CODES:
        assert is_number[row(code / 255) - 10 : row(code / 255) + 10, :LEFT].any()
    assert not is_number[BELOW + 12 :, LEFT:].any()


def test_a_zero_is_a_ring(picture):
    """The number below the right end, dot by dot."""
    is_number = (np.abs(picture[..., :3] - NUMBER) < 1e-6).all(axis=2)
    rows, columns = np.nonzero(is_number[:BELOW, column(-1) : SIZE])
    sign = is_number[rows.min() : rows.max() + 1 : 4, column(-1) + columns.min() : column(-1) + columns.max() + 1 : 4]
    np.testing.assert_array_equal(sign, [[1, 1, 1], [1, 0, 1], [1, 0, 1], [1, 0, 1], [1, 1, 1]])
