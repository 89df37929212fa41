import numpy as np
import pytest

from crfnet_core.posterior import Family, Posterior, Prior, ResponseBank, Verdict
from crfnet_core.response.curve import UNIFORM, ResponseCurve
from crfnet_core.response.emor import EmorBasis
from crfnet_core.response.metrics import estimation_error, shape_error
from crfnet_core.response.transfer_functions import hlg_encode, rec709_encode, srgb_encode
from tests.helpers.posteriors import SMALL_BANK, even_prior, evidence_for


def curves(bank):
    return [ResponseCurve.from_samples(row) for row in bank.brightness]


def test_no_evidence_returns_the_prior(bank):
    prior = even_prior(unexplained=0.2)
    posterior = Posterior.from_evidences(bank, prior)
    for family, members in SMALL_BANK.items():
        np.testing.assert_allclose(posterior.weights[bank.members(family)], 0.2 / len(members))
    unknown = dict.fromkeys((Family.COMPACT, Family.DEVELOPED, Family.EDITED), 0)
    assert posterior.families == pytest.approx(dict(prior.shares) | unknown)


def test_two_photographs_multiply(bank):
    first, second = (evidence_for(bank.weights[number], precision=0.7) for number in (2, 5))
    prior = even_prior()
    alone, other, both = (
        Posterior.from_evidences(bank, prior, asked).weights for asked in ([first], [second], [first, second])
    )
    product = alone * other / Posterior.from_evidences(bank, prior).weights
    np.testing.assert_allclose(both, product / product.sum(), rtol=1e-9)
    again = Posterior.from_evidences(bank, prior, [first, first], independent=0.5)
    np.testing.assert_allclose(again.weights, alone, rtol=1e-9)


def test_the_exponent_of_the_prior_weakens_the_evidence_among_ordinary_responses(bank):
    evidence, prior = evidence_for(bank.weights[4], precision=0.7), even_prior(evidence=0.5)
    whole, half = (Posterior.from_evidences(bank, asked, [evidence]).weights for asked in (even_prior(), prior))
    start = Posterior.from_evidences(bank, prior).weights
    product = (start * (whole / start) ** 0.5)[bank.ordinary]
    np.testing.assert_allclose(half[bank.ordinary], product / product.sum(), rtol=1e-9)
    unmoved = Posterior.from_evidences(bank, even_prior(evidence=0), [evidence]).weights[bank.ordinary]
    np.testing.assert_allclose(unmoved, start[bank.ordinary] / start[bank.ordinary].sum())


@pytest.mark.parametrize(("lookalikes", "share"), [(0.0, 4 / 5), (0.2, 1 / 2), (0.6, 2 / 7)])
def test_lookalikes_bound_what_pixels_say_for_unusual_families(bank, lookalikes, share):
    """By hand: LOG is 16 times as likely as the average of ordinary responses, at prior odds of 1 to 4.

    The odds of 16 become 16, 16 / (0.8 + 3.2) = 4, and 16 / (0.4 + 9.6) = 1.6.
    """
    evidence = evidence_for(bank.weights[4], precision=0.7)
    ordinary = np.exp(evidence.log_likelihoods(bank))[bank.ordinary]
    start = Posterior.from_evidences(bank, even_prior()).weights[bank.ordinary]
    log_odds = (-50.0, float(np.log(16 * (start @ ordinary) / start.sum())), -50.0)
    shares = {Family.PHONE: 4 / 15, Family.CAMERA: 4 / 15, Family.FILM: 4 / 15, Family.LOG: 0.2}
    prior = Prior("p", shares, 0.3, lookalikes)
    posterior = Posterior.from_evidences(bank, prior, [evidence_for(bank.weights[4], precision=0.7, log_odds=log_odds)])
    assert posterior.families[Family.LOG] == pytest.approx(share)


def test_the_unexplained_compete_with_all_responses_together(bank):
    """By hand: prior times evidence of the family, against the sum over the bank."""
    prior, evidence = even_prior(unexplained=0.3), evidence_for(bank.weights[3], log_odds=(-6, -6, -1.5))
    posterior = Posterior.from_evidences(bank, prior, [evidence])
    explained = sum(
        0.7 / len(SMALL_BANK) / bank.members(family).sum() * np.exp(likelihood)
        for family, likelihood in zip(bank.families, evidence.log_likelihoods(bank), strict=True)
    )
    unexplained = 0.3 * np.exp(-1.5)
    assert posterior.unexplained == pytest.approx(unexplained / (explained + unexplained))


@pytest.mark.parametrize("lookalikes", [0.0, 0.2])
def test_plain_responses_widen_the_errors_and_leave_the_answer(bank, lookalikes):
    """By hand: of prior odds and a likelihood ratio, which lookalikes bound."""
    evidence = evidence_for(ResponseBank.plain().weights[2], precision=0.7)
    shares = dict.fromkeys((Family.PHONE, Family.CAMERA, Family.FILM), 1 / 3)
    start = Posterior.from_evidences(bank, Prior("p", shares, 0.3)).weights[bank.ordinary]
    ordinary = start @ np.exp(evidence.log_likelihoods(bank))[bank.ordinary]
    plain = np.exp(evidence.ordinary_log_likelihoods(ResponseBank.plain().weights)).mean()
    odds, ratio = 0.2, plain / ordinary
    posterior = Posterior.from_evidences(bank, Prior("p", shares, 0.3, lookalikes, odds), [evidence])
    without = Posterior.from_evidences(bank, Prior("p", shares, 0.3, lookalikes), [evidence])
    expected = odds * ratio / (1 - lookalikes + lookalikes * ratio)
    assert posterior.families[Family.UNEXPLAINED] == pytest.approx(expected / (1 + expected))
    np.testing.assert_array_equal(posterior.curve.brightness, without.curve.brightness)
    errors = [shape_error(true, posterior.curve) for true in curves(ResponseBank.plain())]
    stated = (1 - posterior.plain.sum()) * without.expected_shape_error + posterior.plain @ errors
    assert posterior.plain.sum() == pytest.approx(expected / (1 + expected))
    assert posterior.expected_shape_error == pytest.approx(stated, rel=5e-3)
    assert not np.allclose(posterior.band(), without.band(), atol=1e-3)


@pytest.mark.parametrize("encode", [srgb_encode, rec709_encode, hlg_encode])
def test_a_plain_encoding_of_a_standard_is_found_among_the_plain_responses(bank, encode):
    true = encode(UNIFORM)
    evidence = evidence_for(EmorBasis.load().project(true), precision=3)
    posterior = Posterior.from_evidences(bank, Prior("p", even_prior().shares, 1.0, 0.0, 0.2), [evidence])
    np.testing.assert_allclose(ResponseBank.plain().brightness[posterior.plain.argmax()], true, atol=1e-6)


def test_the_families_sum_to_1_and_overwhelming_evidence_is_no_overflow(bank):
    for log_odds in ((-2000, -2000, 2000), (-2000, -2000, -2000), (2000, -2000, -2000)):
        posterior = Posterior.from_evidences(
            bank, even_prior(unexplained=0.1), [evidence_for(bank.weights[3], log_odds=log_odds)]
        )
        assert sum(posterior.families.values()) == pytest.approx(1)
        assert np.isfinite(posterior.weights).all()
        assert np.isfinite([posterior.expected_error, posterior.expected_shape_error]).all()


def test_the_answer_is_the_geometric_mean_of_the_inverses(bank):
    """By hand: inverses of powers are powers, and their weighted geometric mean has the mean exponent."""
    posterior = Posterior.from_evidences(bank, even_prior(), [evidence_for(bank.weights[3])])
    exponents = 1 / np.array([power for family in SMALL_BANK.values() for power in family])
    expected = ResponseCurve.gamma(float(posterior.weights @ exponents))
    assert shape_error(expected, posterior.curve) < 0.02
    assert estimation_error(expected, posterior.curve) < 0.15


def test_the_expected_errors_are_means_of_the_metrics_over_the_bank(bank):
    """Of a posterior that no response has alone."""
    blurred = Posterior.from_evidences(bank, even_prior(), [evidence_for(bank.weights[3], precision=1.0)])
    errors = [estimation_error(true, blurred.curve) for true in curves(bank)]
    shapes = [shape_error(true, blurred.curve) for true in curves(bank)]
    assert blurred.expected_error == pytest.approx(blurred.weights @ errors, rel=1e-2)
    assert blurred.expected_shape_error == pytest.approx(blurred.weights @ shapes, rel=5e-2)
    distances = np.linalg.norm(bank.weights - blurred.weights @ bank.weights, axis=1)
    assert blurred.expected_distance == pytest.approx(blurred.weights @ distances)


def test_an_answer_that_weakened_evidence_has_moved_is_doubted(bank):
    """The evidence of exponent 0.2 would move it four times as far again, if it were right; the share is 0.4."""
    prior = even_prior(evidence=0.2)
    before = Posterior.from_evidences(bank, prior).curve
    for number in (1, 3, 6):
        posterior = Posterior.from_evidences(bank, prior, [evidence_for(bank.weights[number], precision=2.0)])
        spread = posterior.weights @ [estimation_error(true, posterior.curve) for true in curves(bank)]
        expected = 0.6 * spread + 0.4 * 4 * estimation_error(before, posterior.curve)
        assert posterior.expected_error == pytest.approx(expected, rel=1e-2)


def test_the_band_holds_nine_tenths_of_the_weight():
    powers = np.linspace(0.3, 0.8, 400)
    bank = ResponseBank((UNIFORM ** powers[:, None]).astype(np.float32), (Family.CAMERA,) * 400)
    posterior = Posterior.from_evidences(bank, Prior("p", {Family.CAMERA: 1.0}, 1.0))
    lower, upper = posterior.band()
    assert lower.shape == upper.shape == (1024,)
    assert (lower <= upper).all()
    for sample in (128, 512, 896):  # knots of the band
        knot = round(sample / 1023 * 64) * 1023 // 64
        inside = (bank.brightness[:, knot] >= lower[knot]) & (bank.brightness[:, knot] <= upper[knot])
        assert posterior.weights[inside].sum() == pytest.approx(0.9, abs=0.02)


@pytest.mark.parametrize(
    ("families", "spread", "expected"),
    [
        ((Family.CAMERA,) * 2, 0.12, Verdict.USABLE),
        ((Family.CAMERA,) * 2, 0.4, Verdict.DO_NOT_TRUST),
        *(((family,) * 2, 0.02, Verdict.DO_NOT_TRUST) for family in (Family.LINEAR, Family.LOG)),
    ],
)
def test_the_verdict_follows_the_expected_stops_and_the_family(families, spread, expected):
    powers = 0.45 * np.exp([[-spread], [spread]])
    bank = ResponseBank((UNIFORM**powers).astype(np.float32), families)
    posterior = Posterior.from_evidences(bank, Prior("p", {families[0]: 1.0}, 1.0))
    assert Verdict.from_posterior(posterior) is expected


def test_a_picture_that_nothing_explains_is_not_to_be_trusted(bank):
    evidence = evidence_for(bank.weights[3], precision=300, log_odds=(-20, -20, 3))
    sure = Posterior.from_evidences(bank, even_prior(unexplained=0.5), [evidence])
    assert Verdict.from_posterior(sure) is Verdict.DO_NOT_TRUST
    assert Verdict.from_posterior(Posterior.from_evidences(bank, even_prior(), [evidence])) is Verdict.USABLE
