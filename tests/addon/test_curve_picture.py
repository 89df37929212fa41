"""The picture of a response, pixel by pixel."""

import numpy as np
import pytest

from blender_addon.work.curve_picture import BACKGROUND, BAND, CURVE, EXTENT, GRID, MARGIN, SIZE, draw_response

UNIFORM = np.linspace(0, 1, 1024)


@pytest.fixture(scope="module")
def picture():
    response = np.sqrt(UNIFORM)
    return draw_response(response, np.clip(response - 0.1, 0, 1), response)


def column(stops):
    """The column of so many stops relative to white, from -8 at the left to 0 at the right."""
    return round(MARGIN + (stops + 8) / 8 * EXTENT)


def row(brightness):
    return round(MARGIN + brightness * EXTENT)


def assert_color(pixels, color):
    np.testing.assert_allclose(pixels[..., :3], np.broadcast_to(color, pixels[..., :3].shape), atol=1e-6)


def test_it_is_an_image_as_blender_stores_it_with_an_empty_margin(picture):
    assert picture.shape == (SIZE, SIZE, 4)
    assert picture.dtype == np.float32
    assert (picture[..., 3] == 1).all()
    assert ((picture >= 0) & (picture <= 1)).all()
    for margin in (picture[SIZE - 5 :], picture[:, SIZE - 5 :], picture[:5], picture[:, :2]):
        assert_color(margin, BACKGROUND)


@pytest.mark.parametrize("stops", [-6.5, -4, -2.5, -1])
def test_the_curve_goes_through_the_responses_values(picture, stops):
    """The square root of light halves its stops."""
    assert_color(picture[row(2 ** (stops / 2)), column(stops)], CURVE)


def test_the_band_is_below_the_curve_here(picture):
    brightness = 2 ** (-2.5 / 2)
    assert_color(picture[row(brightness - 0.05), column(-2.5)], BAND)
    assert_color(picture[row(brightness - 0.15), column(-2.5)], BACKGROUND)
    assert_color(picture[row(0.98), column(-2.5)], BACKGROUND)


def test_the_grid_has_a_line_every_two_stops_and_every_64_codes(picture):
    assert_color(picture[row(0.9), column(-6)], GRID)
    assert_color(picture[row(128 / 255), column(-7)], GRID)
