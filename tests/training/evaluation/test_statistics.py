import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")
pytest.importorskip("PIL", reason="training needs the train extra")

from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import estimation_error, peak_signal_to_noise
from training.data.curves import geometric_median
from training.evaluation.baselines import (
    constant_curves,
    mean_in_log_irradiance,
    nearest_power,
    oracle_curves,
)
from training.evaluation.gamma_level import gamma_levels
from training.evaluation.measure.figures import PhotographFigures
from training.evaluation.summaries.bootstrap import Resampling
from training.evaluation.summaries.error_table import ErrorColumns, ErrorTable
from training.evaluation.summaries.reliability import rejection_curve, reliability
from training.evaluation.test_sets import bundled_test_set

UNIFORM = np.linspace(0, 1, 1024)


@pytest.fixture
def rng():
    return np.random.default_rng(4)


def crossed(scenes, curves):
    """Labels of every scene with every curve."""
    return tuple(part.ravel() for part in np.meshgrid(np.arange(scenes), np.arange(curves), indexing="ij"))


def test_the_first_sample_is_the_plain_figure(rng):
    values = rng.uniform(0, 3, 60)
    resampling = Resampling.of(*crossed(6, 10), seed=1)
    assert resampling.mean(values).value == pytest.approx(values.mean())
    assert resampling.quantile(values, 0.5).value == np.sort(values)[29]
    assert resampling.quantile(values, 0.9).value == np.sort(values)[53]


def test_the_interval_is_that_of_scenes_and_curves_together(rng):
    scenes, curves = crossed(30, 40)
    by_scene, by_curve = rng.normal(0, 1, 30), rng.normal(0, 2, 40)
    values = 10 + by_scene[scenes] + by_curve[curves]
    found = Resampling.of(scenes, curves, seed=1).mean(values)
    expected = 1.96 * np.sqrt(by_scene.var() / 30 + by_curve.var() / 40)
    assert (found.high - found.low) / 2 == pytest.approx(expected, rel=0.08)
    assert found.low < found.value < found.high


def test_weighted_quantiles_are_those_of_repeated_values(rng):
    values, counts = rng.uniform(0, 1, 25), rng.integers(0, 4, 25)
    repeated = np.sort(np.repeat(values, counts))
    weights = np.stack([np.ones(25), counts.astype(float)])
    found = Resampling(weights).quantiles(values, 0.9)[1]
    assert found == repeated[int(np.ceil(0.9 * len(repeated))) - 1]


def test_paired_differences_see_what_intervals_hide(rng):
    scenes, curves = crossed(10, 20)
    values = rng.normal(0, 1, 10)[scenes] + rng.normal(0, 1, 20)[curves] + 5
    resampling = Resampling.of(scenes, curves, seed=1)
    better = values - 0.1 + rng.normal(0, 0.01, 200)
    assert resampling.mean(better).high > resampling.mean(values).low
    assert not resampling.difference(better, values).contains_zero
    assert resampling.difference(values, values).contains_zero


def test_the_same_seed_gives_the_same_intervals(rng):
    values = rng.uniform(0, 1, 12)
    first, second, other = (Resampling.of(*crossed(3, 4), seed=seed).mean(values) for seed in (7, 7, 8))
    assert first == second
    assert first != other


def columns(estimation, linearization, shape):
    """The figures of an estimator with these errors."""
    rows = zip(estimation, linearization, shape, strict=True)
    return ErrorColumns.of([PhotographFigures(*row, partial=0.0) for row in rows])


def test_the_summary_has_the_figures_of_the_metrics(rng):
    errors, gamma = rng.uniform(0, 3, 60), rng.uniform(1, 4, 60)
    parts = {
        "model": columns(errors, errors / 100, errors[::-1]),
        "gamma 2.2": columns(gamma, gamma / 100, gamma),
    }
    found = ErrorTable(parts, Resampling.of(*crossed(6, 10), seed=1)).summary("model")
    assert found.errors.estimation.mean.value == pytest.approx(errors.mean())
    assert found.errors.estimation.median.value == np.sort(errors)[29]
    assert found.errors.estimation.win_rate.value == pytest.approx((errors < gamma).mean())
    assert found.errors.linearization.mean.value == pytest.approx(errors.mean())  # x 1e-2
    assert found.errors.linearization.ratio.value == pytest.approx(errors.mean() / gamma.mean())
    assert found.errors.shape.p90.value == np.sort(errors)[53]
    assert found.errors.shape.win_rate.value == pytest.approx((errors[::-1] < gamma).mean())
    assert found.psnr.value == pytest.approx(peak_signal_to_noise(errors.mean() / 100))
    assert found.psnr.low < found.psnr.high
    named = found.named()
    assert (named["shape mean"], named["E_est win rate"]) == (
        found.errors.shape.mean.value,
        found.errors.estimation.win_rate.value,
    )


def test_differences_name_the_better_model_or_a_tie(rng):
    estimation, linearization = rng.uniform(1, 2, 60), rng.uniform(0.01, 0.02, 60)
    parts = {
        "good": columns(estimation, linearization, estimation),
        "bad": columns(estimation + 1, linearization[::-1], estimation),
    }
    (found,) = ErrorTable(parts, Resampling.of(*crossed(6, 10), seed=1)).differences(["bad", "good"])
    verdicts = {error: comparison.verdict for error, comparison in found.errors.items()}
    assert verdicts == {"E_est": "good is better", "E_lin": "tie", "shape": "tie"}


def test_baselines_against_gamma_2_2():
    true = ResponseCurve.gamma(2.2)
    curves = constant_curves(bundled_test_set().curves) | oracle_curves(true)
    errors = {name: estimation_error(true, curve) for name, curve in curves.items()}
    expected = {
        "gamma 2.2": 0.0,
        "sRGB": 0.1846,
        "Rec.709": 1.1214,
        "mean curve": 1.1841,
        "geometric median curve": 0.9662,
        "oracle: best gamma": 0.0,
        "oracle: EMoR, 1 component": 1.1799,
        "oracle: EMoR, 2 components": 0.3236,
        "oracle: EMoR, 3 components": 0.1736,
        "oracle: EMoR, 5 components": 0.0669,
        "oracle: EMoR, 11 components": 0.0056,
    }
    assert list(errors) == list(expected)
    assert errors == pytest.approx(expected, abs=1e-3)


def test_the_nearest_power_of_an_s_curve_is_the_least_of_a_grid():
    true = ResponseCurve.from_samples(UNIFORM**0.4 * (2 - UNIFORM**0.4))
    grid = [np.linalg.norm(true.brightness - UNIFORM**p) for p in np.linspace(0.05, 2, 2000)]
    assert estimation_error(true, nearest_power(true)) == pytest.approx(min(grid), abs=2e-3)


def test_the_geometric_median_ignores_an_outlier():
    curves = np.stack([UNIFORM**p for p in (0.5, 0.5, 0.5, 3.0)])
    np.testing.assert_allclose(geometric_median(curves), UNIFORM**0.5, atol=1e-3)


def test_the_mean_in_log_irradiance_of_two_powers_is_the_power_between():
    """By hand: g1 = B ** 1.5 and g2 = B ** 2.5 have the geometric mean B ** 2."""
    mean = mean_in_log_irradiance([ResponseCurve.gamma(1.5), ResponseCurve.gamma(2.5)])
    assert estimation_error(ResponseCurve.gamma(2.0), mean) < 0.02


def test_a_perfect_uncertainty_gains_everything(rng):
    errors = rng.uniform(0, 3, 80)
    found = reliability(errors, errors, np.full(80, 0.9))
    assert (found.rank_correlation, found.gain, found.band_coverage) == pytest.approx((1, 1, 0.9))
    assert all(part.uncertainty == part.error and part.photographs == 10 for part in found.bins)


def test_a_reversed_uncertainty_loses_and_a_constant_one_gains_nothing(rng):
    errors = rng.uniform(0, 3, 80)
    assert reliability(errors, -errors, np.ones(80)).gain < -0.5
    constant = reliability(errors, np.full(80, 1.5), np.ones(80))
    assert (constant.rank_correlation, constant.gain) == pytest.approx((0, 0), abs=1e-12)


def test_rejection_removes_the_most_doubtful_first():
    np.testing.assert_allclose(rejection_curve(np.array([1.0, 3.0, 2.0]), np.array([1, 3, 2])), [2, 1.5, 1])


def test_gamma_2_2_is_worse_on_brighter_photographs():
    dark, plain = gamma_levels(bundled_test_set(), (0.25, 1.0))
    assert 100 * plain.errors.mean() == pytest.approx(5.54, abs=0.15)
    assert 100 * dark.errors.mean() == pytest.approx(4.24, abs=0.15)
    assert (dark.irradiance < plain.irradiance).all()
    assert (plain.unscaled <= plain.errors + 1e-12).all()
