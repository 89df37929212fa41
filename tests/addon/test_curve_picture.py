"""The picture of a response, pixel by pixel."""

import numpy as np
import pytest

from blender_addon.work.curve_picture import BACKGROUND, BAND, CURVE, MARGIN, SIZE, draw_response

UNIFORM = np.linspace(0, 1, 1024)

#: Pixels from one axis to the other.
SPAN = SIZE - 2 * MARGIN - 1


@pytest.fixture(scope="module")
def picture():
    response = np.sqrt(UNIFORM)
    return draw_response(response, np.clip(response - 0.1, 0, 1), response)


def test_it_is_an_image_as_blender_stores_it(picture):
    assert picture.shape == (SIZE, SIZE, 4)
    assert picture.dtype == np.float32
    assert (picture[..., 3] == 1).all()
    assert ((picture >= 0) & (picture <= 1)).all()


def test_the_margin_is_empty(picture):
    np.testing.assert_allclose(picture[0, 0, :3], BACKGROUND)
    np.testing.assert_array_equal(picture[:, : MARGIN - 2], picture[:1, :1].repeat(SIZE, 0).repeat(MARGIN - 2, 1))


def test_the_curve_goes_through_the_responses_values(picture):
    """At a quarter of the irradiance the square root is a half."""
    column = MARGIN + SPAN // 4
    row = round(MARGIN + np.sqrt((column - MARGIN) / SPAN) * SPAN)
    np.testing.assert_allclose(picture[row, column, :3], CURVE, atol=1e-6)


def test_the_band_is_below_the_curve_here(picture):
    column = MARGIN + SPAN // 4
    row = round(MARGIN + (np.sqrt((column - MARGIN) / SPAN) - 0.05) * SPAN)
    np.testing.assert_allclose(picture[row, column, :3], BAND, atol=1e-6)
    np.testing.assert_allclose(picture[row + SPAN // 10, column, :3], BACKGROUND, atol=1e-6)
