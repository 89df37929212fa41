import numpy as np
import pytest

from training.evaluation.report import summary
from training.evaluation.report.cases import Cases, Resampling


def crossed(scenes, curves):
    """Labels of every scene with every curve."""
    return tuple(part.ravel() for part in np.meshgrid(np.arange(scenes), np.arange(curves), indexing="ij"))


def cases(**estimators):
    """Photographs of 6 scenes through 10 curves, from estimator -> columns of figures."""
    places = [{"scene number": scene, "curve": curve} for scene, curve in zip(*crossed(6, 10), strict=True)]
    return Cases(
        {
            name.replace("gamma", "gamma 2.2"): [
                place | {column: values[number] for column, values in columns.items()}
                for number, place in enumerate(places)
            ]
            for name, columns in estimators.items()
        }
    )


def errors(estimation, linearization, shape):
    return {"E_est": estimation, "E_lin": linearization, "shape": shape}


def test_the_interval_is_that_of_scenes_and_curves_together(rng):
    scenes, curves = crossed(30, 40)
    by_scene, by_curve = rng.normal(0, 1, 30), rng.normal(0, 2, 40)
    values = 10 + by_scene[scenes] + by_curve[curves]
    mean = Resampling.from_labels(scenes, curves).mean(values)
    expected = 1.96 * np.sqrt(by_scene.var() / 30 + by_curve.var() / 40)
    assert (mean.high - mean.low) / 2 == pytest.approx(expected, rel=0.08)
    assert mean.low < mean.value < mean.high


def test_figures_are_those_of_the_metrics(rng):
    model, gamma = rng.uniform(0, 3, 60), rng.uniform(1, 4, 60)
    parts = cases(model=errors(model, model, model[::-1]), gamma=errors(gamma, gamma, gamma))
    figures = summary.errors(parts, "model")
    assert figures["E_est mean"].value == pytest.approx(model.mean())
    assert figures["E_est median"].value == np.sort(model)[29]
    assert figures["E_est win rate"].value == pytest.approx((model < gamma).mean())
    assert figures["E_lin ratio"].value == pytest.approx(model.mean() / gamma.mean())
    assert figures["shape p90"].value == np.sort(model)[53]
    psnr = figures["PSNR of the mean"]
    assert psnr.value == pytest.approx(-20 * np.log10(model.mean() / 100))
    assert psnr.low < psnr.high


def test_paired_differences_see_what_intervals_hide(rng):
    scenes, curves = crossed(6, 10)
    model = rng.normal(0, 1, 6)[scenes] + rng.normal(0, 1, 10)[curves] + 5
    better = model - 0.1 + rng.normal(0, 0.01, 60)
    parts = cases(better=errors(better, model, model), model=errors(model, model, model))
    weights, figures = parts.resampling, summary.differences(parts, "better", "model")
    assert weights.mean(better).high > weights.mean(model).low
    assert figures["E_est difference"].value < 0
    assert not figures["E_est difference"].low <= 0 <= figures["E_est difference"].high
    assert figures["shape difference"].low <= 0 <= figures["shape difference"].high


@pytest.mark.parametrize(("sign", "least", "most"), [(1, 1, 1), (-1, -9, -0.5), (0, 0, 1e-9)])
def test_an_uncertainty_gains_what_it_foretells(rng, sign, least, most):
    model = rng.uniform(0, 3, 60)
    parts = cases(model={"E_est": model, "expected E_est": sign * model, "band coverage": np.full(60, 0.9)})
    figures = summary.reliability(parts, "E_est", "model")
    assert figures["rank correlation"] == pytest.approx(sign)
    assert least - 1e-9 <= figures["gain"] <= most + 1e-9
    assert figures["band coverage"] == pytest.approx(0.9)


def test_answers_that_are_far_off_and_called_usable_are_counted():
    answers = [(3.5, 0.5, "usable"), (3.5, 0.1, "usable"), (1.0, 0.5, "usable"), (1.0, 0.1, "usable")]
    answers.append((9.0, 0.9, "do not trust"))
    rows = [{"E_est": estimation, "shape": shape, "verdict": verdict} for estimation, shape, verdict in answers]
    assert summary.verdicts(Cases({"model": rows}), "model") == {"accepted": 4, "refused": 1, "far off": 3}


def test_correlations_of_weights_are_over_bodies():
    bodies = [("a", 0.5, 0.6), ("a", 1.5, 1.4), ("b", 2.0, 3.0), ("c", 3.0, 5.0), ("d", 4.0, 7.0)]
    rows = [{"body key": body, "true weights": [true, 0, true], "weights": [w, 0, -w]} for body, true, w in bodies]
    first, second, third = summary.weight_correlations(Cases({"model": rows}), "model").values()
    assert (first.value, second.value, third.value) == pytest.approx((1, 0, -1), abs=1e-3)
    assert summary.weight_correlations(Cases({"model": rows[:3]}), "model") == {}  # two bodies
