import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from crfnet.errors import LutError
from crfnet.luts.lut1d import MAX_COMMENT, MAX_END_SLOPE, Lut1D, inverse_response_lut, strictly_increasing
from crfnet.luts.rgb_lut import RgbLut1D
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.refusals import refusal_of, refused

EXTENDED = (-0.125, 1.125)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_apply_interpolates_clamps_and_takes_nan_for_the_first_entry(kind):
    lut = Lut1D([0.0, 0.25, 1.0])
    result = lut.apply(np.array([-1, 0, 0.25, 0.5, 0.75, 1, 2, np.inf, -np.inf, np.nan], dtype=kind))
    assert (result.dtype, result.tolist()) == (kind, [0, 0, 0.125, 0.25, 0.625, 1, 1, 1, 0, 0])


@pytest.mark.parametrize("domain", [(0.0, 1.0), (-0.125, 1.125)])
def test_a_large_array_has_the_values_of_its_rows(domain):
    """It is worked on in blocks."""
    lut = inverse_response_lut(ResponseCurve.gamma(), domain=domain)
    pixels = np.random.default_rng(0).uniform(-0.5, 1.5, (7, 9999)).astype(np.float32)
    np.testing.assert_array_equal(lut.apply(pixels), np.stack([lut.apply(row) for row in pixels]))


def test_apply_also_of_integers_and_its_inverse_over_a_domain():
    lut = Lut1D([-1.0, 0.0, 4.0], domain=(-1.0, 1.0))
    assert lut.apply([-2, -1, -0.5, 0, 0.5, 1, 2]).tolist() == [-1, -1, -0.5, 0, 2, 4, 4]
    assert lut.apply_inverse([-2, -0.5, 0, 2, 4, 9, np.nan]).tolist() == [-1, -0.5, 0, 0.5, 1, 1, -1]
    codes = np.uint8([0, 51, 255])
    np.testing.assert_allclose(Lut1D([0, 1], domain=(0, 255)).apply(codes), [0, 0.2, 1], atol=1e-6)


def test_pixels_keep_their_shape_and_are_not_written():
    lut = Lut1D([0.0, 0.25, 1.0])
    pixels = np.full((2, 3, 3), 2.0, dtype=np.float32)
    assert lut.apply(pixels).shape == lut.apply_inverse(pixels).shape == (2, 3, 3)
    assert (pixels == 2).all()
    assert lut.apply(0.5).shape == ()
    assert lut.apply(np.zeros((0, 3))).shape == (0, 3)
    assert lut.apply(np.float16([0.5])).dtype == lut.apply(np.array([0.5], ">f4")).dtype == np.float32
    assert lut.apply([1]).dtype == np.float64


@pytest.mark.parametrize(
    ("values", "domain", "code"),
    [
        *((row, (0, 1), "lut_entry") for row in ([0, 0.5, 0.4, 1], [0, np.nan, 1], [0, 1e39], [0, 1, 1 + 1e-9])),
        *((values, (0, 1), "lut_shape") for values in ([0], [[0, 0, 0], [1, 1, 1]], np.arange(65537))),
        *((values, (0, 1), "not_numbers") for values in (None, "01", ["0", "1"], [[0], [1, 0]])),
        *(([0, 1], domain, "lut_domain") for domain in ((1, 0), (0, np.nan), (0,), 1, (0, 1, 2), ((0, 1),))),
        *(([0, 1], domain, "not_numbers") for domain in (None, ("0", "1"))),
        *(([-1e36, 1e36], (0, 1), "lut_span"), ([0, 1], (-1e36, 1e36), "lut_span")),
    ],
)
def test_other_tables_are_refused(values, domain, code):
    assert refusal_of(LutError, Lut1D, values, domain).code == code


def test_a_table_is_its_own_and_single_precision():
    values = np.array([0, 0.1, 1])
    lut = Lut1D(values)
    values[1] = 0.5
    assert lut.values[1] == np.float32(0.1)
    with pytest.raises(ValueError, match="read-only"):
        lut.values[0] = 1
    assert lut == Lut1D([0, 0.1, 1])
    assert lut != Lut1D([0, 0.1, 1], comments=("other",))
    assert lut != Lut1D([0, 0.1, 1], domain=(0, 2))
    assert lut != Lut1D([0, 0.2, 1])
    assert lut != "a LUT"
    assert Lut1D([-1, 1e-40, 1]).values.tolist() == [-1, 0, 1]


def test_comments_become_lines_that_every_format_holds():
    lut = Lut1D([0, 1], comments=("photo:\ta\nb\x00\u2028c.jpg ", "", "é" * 9000, "\udcff"))
    assert lut.comments == ("photo: a b c.jpg", "é" * MAX_COMMENT)


def test_strictly_increasing_raises_by_units_in_the_last_place_and_keeps_the_end():
    below = [np.nextafter(np.float32(1), np.float32(0)), 1]
    assert strictly_increasing([0, 1, 1]).tolist() == [0, *below]
    assert strictly_increasing([-1, 0, 0, 5]).tolist() == [-1, 0, 2.0**-126, 5]
    assert strictly_increasing([-0.5, 0.25, 3]).tolist() == [-0.5, 0.25, 3]


@given(arrays(np.float64, st.integers(2, 200), elements=st.floats(-2, 2, width=32)))
def test_strictly_increasing_moves_values_by_no_more_than_their_number_of_units(values):
    ordered = np.sort(values)
    result = strictly_increasing(ordered)
    assert (np.diff(result.astype(np.float32)) > 0).all()
    assert np.abs(result - ordered).max() <= values.size * np.spacing(np.float32(4))


@pytest.mark.parametrize(
    ("bits", "domain", "length"),
    [
        *((8, (0, 1), length) for length in (256, 4081, 16321, 65536)),
        *((10, (0, 1), length) for length in (1024, 4093)),
        *((12, (0, 1), 4096), (16, (0, 1), 65536)),
        *((8, EXTENDED, 2551), (8, EXTENDED, 5101), (10, EXTENDED, 10231)),
    ],
)
def test_the_documented_lengths_are_exact_on_codes(bits, domain, length, tolerance):
    curve = ResponseCurve.gamma(2.2)
    lut = inverse_response_lut(curve, length=length, domain=domain)
    codes = np.arange(2**bits) / (2**bits - 1)
    wanted = curve.inverse(codes)
    assert np.abs(lut.apply(codes) - wanted).max() < tolerance.lut / 2
    assert np.abs(lut.apply(codes.astype(np.float32)) - wanted).max() < tolerance.lut


def test_where_a_response_jumps_the_entries_still_increase_and_all_codes_come_back():
    lut = inverse_response_lut(ResponseCurve.from_samples(np.arange(1024) > 511), length=65536)
    codes = np.arange(256, dtype=np.float32) / 255
    assert np.rint(lut.apply_inverse(lut.apply(codes)) * 255).tolist() == list(range(256))


def test_super_whites_continue_with_the_slope_of_the_last_code():
    curve = ResponseCurve.gamma(2.2)
    lut = inverse_response_lut(curve, length=5101, domain=EXTENDED)
    toe, shoulder = curve.inverse(1 / 255) * 255, (1 - curve.inverse(254 / 255)) * 255
    assert shoulder == pytest.approx(2.2, abs=0.02)
    np.testing.assert_allclose(lut.apply([1, 1.0625, 1.125, 2]), 1 + shoulder * np.array([0, 1, 2, 2]) / 16, atol=1e-6)
    np.testing.assert_allclose(lut.apply([0, -0.0625, -0.125, -1]), toe * np.array([0, -1, -2, -2]) / 16, atol=1e-6)


def test_the_slope_beyond_a_clipped_end_is_bounded():
    clipped = ResponseCurve.from_samples(np.clip(np.linspace(-0.5, 2, 1024), 0, 1))
    lut = inverse_response_lut(clipped, length=5101, domain=EXTENDED)
    assert MAX_END_SLOPE == 8
    np.testing.assert_allclose(lut.apply([-0.125, 1.125]), [-1, 2], atol=1e-6)


@pytest.mark.parametrize(
    ("code", "choice"),
    [
        *(("lut_domain_short", {"domain": ends}) for ends in ((0.1, 1), (0, 0.9))),
        *(("lut_domain", {"domain": ends}) for ends in ((-np.inf, 1), (0, np.inf), (np.nan, 1), (0,))),
        *(("lut_length", {"length": length}) for length in (-1, 0, 1, 65537, 4081.5, "4081", None, True)),
        *(("lut_comments", {"comments": comments}) for comments in ("text", [1], None)),
    ],
)
def test_choices_that_make_no_lut_of_a_response_are_refused(code, choice):
    assert refusal_of(LutError, inverse_response_lut, ResponseCurve.gamma(), **choice).code == code


@pytest.mark.parametrize("step", [Lut1D.apply, Lut1D.apply_inverse])
def test_code_values_are_refused(true_response, step):
    """Clipped, all but the first would be white."""
    lut = inverse_response_lut(true_response)
    for codes in (np.array([[[0, 128, 255]]], np.uint8), np.uint16([0, 1]), [0, 2]):
        with refused(LutError, "lut_codes", largest=np.max(codes)):
            step(lut, codes)
    for others in ("0.5", [[1], [1, 0]], np.ma.masked_greater([0.2, 0.8], 0.5)):
        assert refusal_of(LutError, step, lut, others).code == "not_numbers"
    with refused(LutError, "lut_pixels"):  # the last channel is alpha, which OpenColorIO keeps
        step(lut, np.zeros((2, 3, 4)))
    np.testing.assert_array_equal(step(lut, np.array([0, 1])), [0, 1])


def test_a_lut_may_reach_beyond_all_brightness(true_response):
    near, far = (inverse_response_lut(true_response, length=5, domain=(0, end)) for end in (1, 4))
    assert (far.values[1], far.values[0]) == (near.values[-1], near.values[0])
    np.testing.assert_allclose(np.diff(far.values[1:]), far.values[2] - far.values[1], rtol=1e-6)


@pytest.mark.parametrize("codes", [np.linspace(0, 255, 9, dtype=np.float32), [np.nan, 3, 4, 0.5, 9], [0.0, 0, 0, 9]])
def test_floating_point_codes_are_refused_and_light_has_no_bound(true_response, codes):
    lut = inverse_response_lut(true_response, domain=(-0.125, 1.125))
    with refused(LutError, "lut_codes"):
        RgbLut1D((lut, lut, lut)).apply(np.stack([codes] * 3, axis=-1))
    with refused(LutError, "lut_pixels"):  # gray, of which the first columns would be R, G and B
        RgbLut1D((lut, lut, lut)).apply(np.zeros((8, 9)))
    assert np.nanmax(lut.apply_inverse(codes)) == pytest.approx(1.125)
