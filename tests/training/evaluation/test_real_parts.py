"""The parts of P4: where files come from, oracles, correlations of weights, verdicts that are too good."""

import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")
pytest.importorskip("PIL", reason="training needs the train extra")
pytest.importorskip("matplotlib", reason="training needs the train extra")

from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.emor import EmorBasis
from crfnet_core.response.metrics import estimation_error, shape_error
from training.data.families import with_headroom
from training.data.real.file_origin import Editing, editing, is_scaled
from training.data.real.photographs import RealPhotograph
from training.evaluation.baselines import nearest_of, with_best_headroom
from training.evaluation.measure.figures import PhotographFigures
from training.evaluation.report.real.content import TrustedWrongly
from training.evaluation.summaries.emor_weights import fitted_weights, weight_correlations
from training.evaluation.summaries.trust import trusted_wrongly

UNIFORM = np.linspace(0, 1, 1024)


@pytest.mark.parametrize(
    ("software", "make", "use", "expected"),
    [
        ("Adobe Photoshop CS6 (Windows)", "Canon", "yes", Editing.EDITED),
        ("", "Canon", "caution: edited/developed by software, jitter>0.2", Editing.EDITED),
        ("Ver.1.00", "NIKON", "yes", Editing.NOT_NAMED),
        ("Microsoft Windows Photo Viewer 6.1", "SONY", "yes", Editing.NOT_NAMED),
        ("", "Canon", "yes", Editing.NOT_NAMED),
        ("", "", "yes", Editing.UNKNOWN),
    ],
)
def test_an_editor_is_known_by_its_name(software, make, use, expected):
    assert editing(software, make=make, use=use) is expected


def test_a_photograph_without_1600_pixels_is_scaled():
    assert [is_scaled(size) for size in ("1280x853", "1600x1200", "2848x4288", "853x1280")] == [
        True,
        False,
        False,
        True,
    ]


def test_answers_that_are_far_off_and_called_usable_are_counted():
    figures = [
        PhotographFigures(3.5, 0.1, 0.5, 3, verdict="usable"),
        PhotographFigures(3.5, 0.1, 0.1, 3, verdict="good"),
        PhotographFigures(1.0, 0.1, 0.5, 1, verdict="usable"),
        PhotographFigures(1.0, 0.1, 0.1, 1, verdict="usable"),
        PhotographFigures(9.0, 0.9, 0.9, 9, verdict="do not trust"),
    ]
    assert trusted_wrongly(figures) == TrustedWrongly(photographs=4, estimation=2, shape=2, either=3)


def test_the_oracle_chooses_the_headroom_and_keeps_the_shape():
    mean = ResponseCurve.from_samples(1 - (1 - UNIFORM**0.6) ** 2)
    for stops in (1.0, -0.4):
        true = with_headroom(mean, stops)
        found = with_best_headroom(mean, true)
        assert estimation_error(true, found) < 0.05 < estimation_error(true, mean)
        assert shape_error(mean, found) < 0.01


def test_the_nearest_curve_is_picked_in_hindsight():
    curves = np.stack([UNIFORM ** (1 / power) for power in (1.4, 2.0, 2.6)])
    assert estimation_error(nearest_of(curves, ResponseCurve.gamma(2.1)), ResponseCurve.gamma(2.0)) < 0.02


def test_correlations_of_weights_are_over_bodies(tmp_path):
    bodies = [("a", 0.5, 0.6), ("a", 1.5, 1.4), ("b", 2.0, 3.0), ("c", 3.0, 5.0), ("d", 4.0, 7.0)]
    photographs, figures = zip(*(case_of_weight(tmp_path, *case) for case in bodies), strict=True)
    first, second, third = weight_correlations(photographs, figures, seed=1)
    assert first.value == pytest.approx(1, abs=1e-3)
    assert -1 <= second.low <= second.high <= 1
    assert -1 <= third.low <= third.high <= 1
    assert weight_correlations(photographs[:3], figures[:3], seed=1) == ()  # two bodies


def case_of_weight(folder, body, true, estimated):
    """A photograph whose response has the first weight `true`, and the figures of a model that says `estimated`."""
    responses = [ResponseCurve.from_samples(EmorBasis.load().reconstruct([w, *[0] * 10])) for w in (true, estimated)]
    measured_file = folder / f"{body}{true}.csv"
    np.savetxt(measured_file, np.stack([UNIFORM, responses[0].brightness], axis=1), delimiter=",", header="e,b")
    photograph = RealPhotograph(
        body, body, "camera", "A", "", True, Editing.UNKNOWN, False, body, folder, measured_file
    )
    drawn = tuple(responses[1].forward(np.linspace(0, 1, 65)))
    return photograph, PhotographFigures(0, 0, 0, 0, uncertainty=1, coverage=1, curve=drawn)


def test_weights_are_found_from_the_kept_samples():
    weights = np.array([[1.0, -0.5, 0.3, *[0] * 8]])
    index = np.linspace(0, 1023, 65).round().astype(int)
    kept = EmorBasis.load().reconstruct(weights)[:, index].round(4)
    assert fitted_weights(kept)[:, :3] == pytest.approx(weights[:, :3], abs=0.01)
