import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")
pytest.importorskip("PIL", reason="training needs the train extra")

from training.synthesis.unusual import log_curves

#: Published codes of 10 bits (black, 18 % gray, 90 % white), from the makers' tables.
PUBLISHED = {
    "ARRI LogC3": (95, 400, 572),
    "Canon Log 3": (128, 351, 577),
    "DJI D-Log": (95, 408, 586),
    "Fujifilm F-Log": (95, 470, 705),
    "Fujifilm F-Log2": (95, 400, 570),
    "Nikon N-Log": (127, 372, 603),
    "Panasonic V-Log": (128, 433, 602),
    "Sony S-Log3": (95, 420, 598),
}

#: The names of the curves in colour-science.
COLOUR_SCIENCE = {
    "ARRI LogC3": "ARRI LogC3",
    "Apple Log": "Apple Log Profile",
    "Canon Log 3": "Canon Log 3",
    "DJI D-Log": "D-Log",
    "Fujifilm F-Log": "F-Log",
    "Fujifilm F-Log2": "F-Log2",
    "Nikon N-Log": "N-Log",
    "Panasonic V-Log": "V-Log",
    "RED Log3G10": "Log3G10",
    "Sony S-Log3": "S-Log3",
}

REFLECTANCE = np.concatenate([[0, 0.001, 0.005, 0.012, 0.18, 0.327, 0.329, 0.9, 1], np.geomspace(2, 50, 9)])


@pytest.mark.parametrize("name", PUBLISHED)
def test_black_gray_and_white_have_their_published_codes(name):
    assert np.rint(log_curves()[name]([0, 0.18, 0.9]) * 1023).tolist() == pytest.approx(PUBLISHED[name], abs=1)


def test_log3g10_puts_gray_at_a_third_and_ten_stops_more_at_the_end():
    np.testing.assert_allclose(log_curves()["RED Log3G10"]([0.18, 0.18 * 2**10]), [1 / 3, 1], atol=1e-4)


@pytest.mark.parametrize("name", log_curves())
def test_the_curve_is_that_of_colour_science(name):
    colour = pytest.importorskip("colour", reason="colour-science comes with the test extra")
    expected = colour.log_encoding(REFLECTANCE, function=COLOUR_SCIENCE[name])
    np.testing.assert_allclose(log_curves()[name](REFLECTANCE), expected, atol=2e-5)


@pytest.mark.parametrize("name", log_curves())
def test_the_curve_rises_from_a_lifted_black(name):
    codes = log_curves()[name](np.linspace(-0.005, 60, 20_000))
    assert (np.diff(codes) > 0).all()
    assert 0.08 < log_curves()[name](0.0) < 0.16
