from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from crfnet_core.emor import EmorBasis
from crfnet_core.errors import PhotoError
from crfnet_core.estimate import estimate_response
from crfnet_core.image_io import read_photo
from crfnet_core.metrics import estimation_error
from crfnet_core.network import Answer, Predictions, ResponseNetwork, UncertaintyModel
from crfnet_core.network.pooling import inliers
from crfnet_core.photo import Photo
from crfnet_core.response import ResponseCurve

UNCERTAINTY_MODEL = UncertaintyModel(base=0.1, of_predicted=0.5, of_spread=2.0, band_profile=(0.0, 0.1, 0.0))


class FakeNetwork:
    """Answers with given rows, whatever the windows."""

    def __init__(self, rows, errors=None, pooled=None):
        self.pooled = pooled
        self.rows = np.asarray(rows, dtype=np.float64)
        self.errors = np.ones(len(self.rows)) if errors is None else np.asarray(errors, dtype=np.float64)
        self.config = SimpleNamespace(uncertainty_model=UNCERTAINTY_MODEL, label="fake 000000000000")

    def inputs(self, windows, *, progress=None):
        return windows

    def predict(self, windows, *, progress=None):
        assert windows.shape == (len(self.rows), 227, 227, 3)
        return Predictions(self.rows, self.errors, self.pooled)


def photo(*, seed=0, shape=(300, 400), codes=(0, 256), is_gray=False, name="plate01.jpg"):
    pixels = np.random.default_rng(seed).integers(*codes, (*shape, 3)).astype(np.float32) / np.float32(255)
    return Photo(pixels=pixels, bit_depth=8, is_gray=is_gray, path=Path("shots") / name)


def rows_around(centre, offsets):
    rows = np.tile(np.asarray(centre, dtype=np.float64), (len(offsets), 1))
    rows[:, 0] += offsets
    return rows


CENTRE = np.array([1.0, -0.5] + [0.0] * 9)


def test_outliers_are_those_beyond_twice_the_median_distance():
    kept = inliers(rows_around(CENTRE, [-0.2, -0.1, 0.0, 0.1, 0.25, 3.0]))
    assert kept.tolist() == [True, True, True, True, True, False]


def test_equal_estimates_are_all_kept():
    assert inliers(rows_around(CENTRE, [0.0] * 5)).all()


def test_the_average_leaves_outliers_out():
    rows = rows_around(CENTRE, [-0.1, -0.1, 0.0, 0.1, 0.1, 5.0])
    estimate = estimate_response(photo(), network=FakeNetwork(rows), windows=6)
    assert [window.kept for window in estimate.windows] == [True] * 5 + [False]
    np.testing.assert_allclose(estimate.weights, CENTRE, atol=1e-12)
    expected = ResponseCurve.from_samples(EmorBasis.load().reconstruct(CENTRE))
    assert estimation_error(expected, estimate.curve) < 1e-9
    assert estimate.spread == pytest.approx(np.sqrt(0.04 / 5))


def test_a_network_that_pools_has_the_last_word():
    """Its windows only tell the spread; its own expected error enters the uncertainty."""
    pooled = Answer(CENTRE + 1, 0.3)
    rows = rows_around(CENTRE, [-0.1, 0.1, 7.0, -0.1, 0.1])
    estimate = estimate_response(photo(), network=FakeNetwork(rows, pooled=pooled), windows=5)
    np.testing.assert_array_equal(estimate.weights, CENTRE + 1)
    assert [window.kept for window in estimate.windows] == [True, True, False, True, True]
    assert estimate.uncertainty == pytest.approx(0.1 + 0.5 * 0.3 + 2.0 * 0.1)


def test_the_coverage_asked_for_reaches_the_choice_of_windows():
    dull = np.full((300, 900, 3), 0.5, np.float32)
    dull[:, 600:] = photo(shape=(300, 300)).pixels
    dull = Photo(pixels=dull, bit_depth=8, is_gray=False, path=Path("dull.jpg"))
    network = FakeNetwork(rows_around(CENTRE, [0.0] * 6))
    asked, any_window = (estimate_response(dull, network=network, windows=6, coverage=c).windows for c in (220, 0))
    assert all(found.window.covers_range for found in asked)
    assert not all(found.window.covers_range for found in any_window)


def test_uncertainty_is_the_calibrated_sum():
    rows = rows_around(CENTRE, [-0.1, 0.1, -0.1, 0.1])
    estimate = estimate_response(photo(), network=FakeNetwork(rows, [0.5, 1.5, 1.0, 1.0]), windows=4)
    assert estimate.spread == pytest.approx(0.1)
    assert estimate.uncertainty == pytest.approx(0.1 + 0.5 * 1.0 + 2.0 * 0.1)


@pytest.mark.parametrize(("error", "verdict"), [(1.0, "good"), (2.0, "usable"), (5.0, "do not trust")])
def test_the_verdict_follows_the_uncertainty(error, verdict):
    network = FakeNetwork(rows_around(CENTRE, [0.0] * 3), [error] * 3)
    assert estimate_response(photo(), network=network, windows=3).verdict == verdict


def test_the_band_has_the_calibrated_width():
    curve = ResponseCurve.from_samples([0.0, 1.0])
    lower, upper = UNCERTAINTY_MODEL.band(curve, 2.0)
    assert (lower[0], upper[0], lower[-1], upper[-1]) == (0, 0, 1, 1)
    np.testing.assert_allclose((upper - lower)[[256, 512, 768]], [0.2, 0.4, 0.2], atol=1e-3)
    assert (lower >= 0).all()
    assert (upper <= 1).all()


def test_photographs_of_one_camera_are_pooled():
    rows = rows_around(CENTRE, [0.1] * 4 + [-0.1] * 4)
    photos = [photo(seed=1, name="a.jpg"), photo(seed=2, name="b.jpg", shape=(500, 300))]
    estimate = estimate_response(photos, network=FakeNetwork(rows), windows=4)
    assert [window.photo for window in estimate.windows] == [0] * 4 + [1] * 4
    np.testing.assert_allclose(estimate.weights, CENTRE, atol=1e-12)
    assert estimate.photos == ("a.jpg", "b.jpg")


def warnings_of(made):
    return estimate_response(made, network=FakeNetwork(rows_around(CENTRE, [0.0] * 2)), windows=2).warnings


def test_a_good_photograph_gives_no_warning():
    assert warnings_of(photo()) == ()


def test_a_photograph_without_the_range_is_warned_of():
    assert "no window covers the range" in warnings_of(photo(codes=(100, 200)))[0]


def test_a_gray_photograph_is_warned_of():
    assert "gray photograph" in warnings_of(photo(is_gray=True))[0]


def test_a_clipped_photograph_is_warned_of():
    clipped = photo()
    clipped.pixels[:200] = 1
    assert "mostly clipped" in warnings_of(clipped)[0]


def test_a_small_photograph_is_named():
    with pytest.raises(PhotoError, match=r"plate01\.jpg: the photograph is 400 x 100 pixels"):
        estimate_response(photo(shape=(100, 400)), network=FakeNetwork([]))


def test_no_photograph_is_refused():
    with pytest.raises(PhotoError, match="no photograph"):
        estimate_response([], network=FakeNetwork([]))


@pytest.fixture(scope="module")
def bundled(plate):
    return estimate_response(read_photo(plate), network=ResponseNetwork.load())


def test_the_bundled_plate_is_estimated_better_than_gamma(bundled, root):
    samples = np.loadtxt(root / "tests" / "data" / "plate_response.csv", delimiter=",", skiprows=1)
    true = ResponseCurve.from_samples(samples[:, 1])
    assert estimation_error(true, bundled.curve) < 0.75 * estimation_error(true, ResponseCurve.gamma())
    assert bundled.warnings == ()


def test_the_same_photograph_gives_the_same_estimate(bundled, plate):
    again = estimate_response(read_photo(plate), network=ResponseNetwork.load(threads=1))
    np.testing.assert_array_equal(again.curve.brightness, bundled.curve.brightness)
    assert again.uncertainty == bundled.uncertainty
