from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from crfnet_core.errors import CurveError
from crfnet_core.response.curve import BLOCK, LEAST_SLOPE, SAMPLES, UNIFORM, ResponseCurve, nearest_increasing
from crfnet_core.response.emor import COMPONENTS, EmorBasis
from crfnet_core.response.metrics import estimation_error, linearization_error, scale_error, shape_error
from crfnet_core.response.transfer_functions import hlg_encode, rec709_encode, srgb_encode
from tests.helpers.refusals import refusal_of

weights = arrays(np.float64, 11, elements=st.floats(-8, 8))


def test_gamma_has_the_values_of_a_power_law_and_other_numbers_of_samples_are_resampled():
    curve = ResponseCurve.gamma(2.0)
    assert curve == ResponseCurve.gamma(np.float16(2)) == ResponseCurve.gamma(Fraction(2))
    np.testing.assert_allclose(curve.forward([0, 0.25, 0.64, 1]), [0, 0.5, 0.8, 1], atol=2e-4)
    np.testing.assert_allclose(curve.inverse([0, 0.5, 0.8, 1]), [0, 0.25, 0.64, 1], atol=3e-4)
    np.testing.assert_allclose(ResponseCurve.from_samples([0.0, 0.5, 1.0]).brightness, UNIFORM, atol=1e-12)


def test_the_transfer_functions_of_standards_are_those_of_colour_science(tolerance):
    models = pytest.importorskip("colour", reason="colour-science comes with the test extra").models
    np.testing.assert_allclose(srgb_encode(UNIFORM), models.eotf_inverse_sRGB(UNIFORM), atol=tolerance.exact)
    np.testing.assert_allclose(rec709_encode(UNIFORM), models.oetf_BT709(UNIFORM), atol=tolerance.exact)
    np.testing.assert_allclose(hlg_encode(UNIFORM[90:]), models.oetf_BT2100_HLG(UNIFORM[90:]), atol=1e-8)
    np.testing.assert_allclose(hlg_encode([0, 1 / 48, 1 / 12]), [0, 0.25, 0.5])


@given(weights)
@settings(max_examples=200, deadline=None)
def test_random_emor_weights_become_strict_responses_that_invert(drawn):
    samples = EmorBasis.load().reconstruct(drawn)
    if samples[-1] <= samples[0]:
        with pytest.raises(CurveError):
            ResponseCurve.from_samples(samples)
        return
    curve = ResponseCurve.from_samples(samples)
    assert (curve.brightness[0], curve.brightness[-1]) == (0, 1)
    assert (np.diff(curve.brightness) >= 0.5 * LEAST_SLOPE / SAMPLES).all()
    np.testing.assert_allclose(curve.inverse(curve.forward(UNIFORM)), UNIFORM, atol=1e-9)
    codes = np.arange(256) / 255
    np.testing.assert_allclose(curve.forward(curve.inverse(codes)), codes, atol=1e-9)


@given(weights, st.floats(0.3, 3))
@settings(max_examples=100, deadline=None)
def test_monotonicity_never_raises_the_error(drawn, exponent):
    """The projection brings samples no farther from any increasing curve, but for the least slope mixed in."""
    samples = EmorBasis.load().reconstruct(drawn)
    if samples[-1] <= samples[0]:
        return
    truth = UNIFORM**exponent
    scaled = np.clip((samples - samples[0]) / (samples[-1] - samples[0]), 0, 1)
    before = np.linalg.norm(scaled - truth)
    after = np.linalg.norm(ResponseCurve.from_samples(samples).brightness - truth)
    assert after <= before + LEAST_SLOPE * np.sqrt(SAMPLES)


@given(arrays(np.float64, st.integers(1, 60), elements=st.floats(-10, 10)))
@settings(deadline=None)
def test_nearest_increasing_is_the_projection(samples):
    nearest = nearest_increasing(samples)
    assert (np.diff(nearest) >= 0).all()
    gap = samples - nearest
    assert abs(gap @ nearest) < 1e-6 * max(1, np.abs(samples).max() ** 2 * len(samples))
    for start in range(len(samples)):
        assert gap[start:].sum() < 1e-6


@pytest.mark.parametrize(
    ("make", "argument", "code"),
    [
        *((ResponseCurve.from_samples, row, "curve_samples") for row in ([0.0], [0.0, np.nan, 1.0], [[0.0, 1.0]])),
        *((ResponseCurve.from_samples, row, "curve_dark") for row in ([1.0, 0.0], [0.5, 0.5])),
        (ResponseCurve, np.zeros(SAMPLES), "curve_not_strict"),
        (ResponseCurve, np.linspace(0, 1, 10), "curve_shape"),
        *((ResponseCurve.gamma, no, "curve_exponent") for no in (0, -1, np.nan, np.inf, True, "2", None, [2.2])),
        *((make, "x", "not_numbers") for make in (ResponseCurve, ResponseCurve.from_samples)),
    ],
)
def test_what_makes_no_curve_is_refused(make, argument, code):
    assert refusal_of(CurveError, make, argument).code == code


def steep():
    """A response that clips: its last samples lie closer together than the cells of the table."""
    return ResponseCurve.from_samples(np.minimum(UNIFORM * 1.5, 1) ** 0.4)


@pytest.mark.parametrize("function", ["forward", "inverse"])
@pytest.mark.parametrize("curve", [ResponseCurve.gamma(), steep()], ids=["gamma", "steep"])
def test_large_arrays_have_the_values_of_small_ones(curve, function):
    """To the last bit: at the samples, between them, at the ends, beyond them, and NaN."""
    values = np.random.default_rng(0).uniform(-0.1, 1.1, BLOCK + 5000)
    values[:2048] = np.concatenate([curve.brightness, curve.irradiance])
    values[2048:2054] = [0, 1, np.nan, -np.inf, 2, np.nextafter(1, 0)]
    values[3000:4000] = np.linspace(0.99999, 1, 1000)
    before = values.copy()
    call = getattr(curve, function)
    found = call(values)
    np.testing.assert_array_equal(found, np.concatenate([call(part) for part in np.split(values, [BLOCK - 7])]))
    assert np.flatnonzero(np.isnan(found)).tolist() == [2050]
    assert found[[2048, 2049, 2051, 2052]].tolist() == [0, 1, 0, 1]
    np.testing.assert_array_equal(values, before)


@pytest.mark.parametrize("size", [7, BLOCK + 7])
@pytest.mark.parametrize(
    ("given", "kind"),
    [("float16", "float32"), ("float32", "float32"), ("float64", "float64"), (">f4", "float32"), ("int64", "float64")],
)
def test_single_precision_stays_single_precision(given, kind, size):
    curve = ResponseCurve.gamma()
    values = (np.arange(2 * size) % 2).astype(given).reshape(2, size)
    for call in (curve.forward, curve.inverse):
        found = call(values.T)
        assert (found.dtype, found.shape) == (np.dtype(kind), (size, 2))
        np.testing.assert_array_equal(found, values.T)


def test_a_number_gives_a_number():
    curve = ResponseCurve.gamma()
    assert isinstance(curve.inverse(0.5), float)
    assert isinstance(curve.forward(1), float)
    assert curve.forward(curve.inverse(0.5)) == pytest.approx(0.5, abs=1e-12)
    assert curve.inverse(np.float32(0.5)).dtype == np.float32


@pytest.mark.parametrize(
    "codes",
    [
        *(np.full((2, 2, 3), 200, np.uint8), np.array([1023], np.uint16), [0, 128, 255], 255),
        *(np.array([np.nan, 0, 255], np.float32), np.linspace(0, 65535, BLOCK + 1), 128.5, np.uint8([0, 1])),
    ],
)
def test_code_values_are_refused(codes):
    assert refusal_of(CurveError, ResponseCurve.gamma().inverse, codes).code == "brightness_codes"


def test_a_few_numbers_above_white_are_clipped():
    picture = np.full((9, 9, 3), 0.5, np.float32)
    picture[0, 0] = (2.5, np.inf, np.nan)  # as at an edge whose colors were divided by alpha
    np.testing.assert_array_equal(ResponseCurve.gamma().inverse(picture)[0, 0], (1, 1, np.nan))


class OnDevice:
    """A tensor of PyTorch that is not in memory, or has a gradient."""

    def __array__(self, dtype=None, copy=None):
        raise RuntimeError("call detach first")


@pytest.mark.parametrize(
    "argument", [None, "0.5", [1j], [[1], [1, 0]], np.ma.masked_greater([0.2, 0.8], 0.5), OnDevice()]
)
@pytest.mark.parametrize("function", ["forward", "inverse"])
def test_anything_but_numbers_is_refused(argument, function):
    assert refusal_of(CurveError, getattr(ResponseCurve.gamma(), function), argument).code == "not_numbers"


def test_the_irradiances_are_uniform_and_cannot_be_changed():
    curve = ResponseCurve.gamma()
    np.testing.assert_array_equal(curve.irradiance, UNIFORM)
    np.testing.assert_array_equal(curve.forward(curve.irradiance), curve.brightness)
    with pytest.raises(ValueError, match="read-only"):
        curve.irradiance[3] = 0.5


def test_the_packaged_basis_is_orthonormal_about_a_mean_from_0_to_1():
    mean, components = EmorBasis.load().mean, EmorBasis.load().components
    assert (mean.shape, components.shape) == ((SAMPLES,), (COMPONENTS, SAMPLES))
    np.testing.assert_allclose(components @ components.T, np.eye(COMPONENTS), atol=1e-12)
    assert (components.sum(axis=1) > 0).all()
    np.testing.assert_allclose(mean[[0, 512, -1]], [0, 0.75436, 1], atol=5e-5)
    assert (np.diff(mean) > 0).all()


def test_project_undoes_reconstruct():
    weights = np.random.default_rng(0).normal(size=(4, 3, COMPONENTS))
    basis = EmorBasis.load()
    assert basis.reconstruct(weights).shape == (4, 3, SAMPLES)
    np.testing.assert_allclose(basis.project(basis.reconstruct(weights)), weights, atol=1e-12)


@pytest.mark.parametrize("values", ["x", None, [[0], [1, 0]], 0.5, [], np.zeros((2, 5))])
@pytest.mark.parametrize(("function", "length"), [(EmorBasis.project, SAMPLES), (EmorBasis.reconstruct, COMPONENTS)])
def test_other_values_are_refused(values, function, length):
    for each in (values, np.full(length, np.nan)):
        with pytest.raises(CurveError):
            function(EmorBasis.load(), each)


@pytest.mark.parametrize("curve", [255 * UNIFORM, np.round(255 * UNIFORM).astype("u1"), 1 - UNIFORM, 0 * UNIFORM])
def test_curves_that_do_not_run_from_0_to_1_have_no_weights(curve):
    with pytest.raises(CurveError):
        EmorBasis.load().project([UNIFORM, curve])


def test_a_basis_of_curves_explains_them_in_order():
    rng = np.random.default_rng(2)
    exponents = np.exp(rng.normal(0, 0.4, 40))
    curves = UNIFORM ** exponents[:, None]
    basis = EmorBasis.from_curves(curves)
    assert (np.diff(np.var(basis.project(curves), axis=0)) <= 0).all()
    np.testing.assert_allclose(basis.reconstruct(basis.project(curves)), curves, atol=1e-4)


def test_a_basis_needs_enough_curves():
    with pytest.raises(ValueError, match="needs more than 11 curves"):
        EmorBasis.from_curves(np.zeros((5, SAMPLES)))


STRAIGHT = ResponseCurve.from_samples([0.0, 1.0])
SQUARE = ResponseCurve.gamma(0.5)


def test_estimation_error_of_two_known_curves():
    """The L2 distance of E and E ** 2: sqrt(1024 * integral of (x - x^2)^2) = sqrt(1024 / 30)."""
    assert estimation_error(STRAIGHT, SQUARE) == pytest.approx(np.sqrt(SAMPLES / 30), rel=2e-3)
    assert estimation_error(STRAIGHT, STRAIGHT) == 0
    assert estimation_error(STRAIGHT, SQUARE) == estimation_error(SQUARE, STRAIGHT)


def test_linearization_error_of_known_pixels():
    """By hand: B = 0.25 is E = 0.25 on the straight line, and 0.5 on the square."""
    assert linearization_error([0.25, 1.0], STRAIGHT, SQUARE) == pytest.approx(0.25 / np.sqrt(2), abs=1e-3)


def test_counts_stand_for_repeated_pixels():
    pixels = np.array([0.1, 0.1, 0.1, 0.6, 0.9, 0.9])
    counted = linearization_error([0.1, 0.6, 0.9, 1.0], STRAIGHT, SQUARE, counts=[3, 1, 2, 0])
    assert counted == pytest.approx(linearization_error(pixels, STRAIGHT, SQUARE), rel=1e-12)


def test_the_shape_error_of_two_powers():
    """By hand: log2(B ** 2 / B) = log2(B), whose spread over the codes 16 to 240 is a sum of logarithms."""
    assert shape_error(STRAIGHT, SQUARE) == pytest.approx(np.std(np.log2(np.arange(16, 241))) / 2, rel=2e-2)


def test_the_shape_error_ignores_the_exposure_which_is_the_scale_error():
    """f(E) = 2 E until it clips: the linear light of codes below white is off by one stop everywhere."""
    clipped = ResponseCurve.from_samples(np.minimum(2 * UNIFORM, 1))
    assert estimation_error(STRAIGHT, clipped) > 5
    assert shape_error(STRAIGHT, clipped) < 2e-3
    assert scale_error(STRAIGHT, clipped) == pytest.approx(-1, abs=2e-3)
    assert scale_error(clipped, STRAIGHT) == pytest.approx(1, abs=2e-3)
