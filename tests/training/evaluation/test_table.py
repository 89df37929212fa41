import numpy as np
import pytest

from crfnet_core.errors import CRFNetError
from crfnet_core.response.curve import UNIFORM, ResponseCurve
from crfnet_core.response.metrics import estimation_error, linearization_error, shape_error
from training.evaluation.measure.figures import curve_figures
from training.evaluation.measure.table import Table
from training.evaluation.report.cases import Cases

SETTINGS = {"seed": 1, "test_set": "abc"}


def row(photograph, estimator="model", model="123", **columns):
    return {"protocol": "P0", "photograph": photograph, "estimator": estimator, "model": model} | columns


@pytest.fixture
def table(tmp_path):
    table = Table(tmp_path / "out" / "photographs.jsonl", SETTINGS)
    table.add([row(name, E_est=number / 8) for number, name in enumerate("abc")])
    table.add([row("a", "gamma 2.2", "", E_est=1.0)])
    return table


def again(table, *, settings=SETTINGS):
    return Table(table.path, settings)


def test_rows_come_back_in_the_order_asked_for(table):
    rows = again(table).rows("P0", {"model": "123"}, ["c", "a"])["model"]
    assert [one["E_est"] for one in rows] == [0.25, 0.0]
    assert table.baselines("P0") == {"gamma 2.2": ""}


def test_rows_of_another_model_have_to_be_measured(table):
    read = again(table)
    assert not read.lacks("P0", "a", "model", "123")
    assert read.lacks("P0", "a", "model", "456")
    assert read.lacks("P2", "a", "model", "123")


def test_a_table_of_other_settings_is_refused(table):
    with pytest.raises(CRFNetError, match="other settings"):
        again(table, settings=SETTINGS | {"seed": 2})


def test_a_row_that_was_cut_off_is_measured_again(table):
    table.path.write_bytes(table.path.read_bytes()[:-5])
    read = again(table)
    assert read.lacks("P0", "a", "gamma 2.2")
    read.add([row("a", "gamma 2.2", "", E_est=2.0)])
    assert again(table).rows("P0", {"gamma 2.2": ""}, "a")["gamma 2.2"][0]["E_est"] == 2.0


def test_rows_of_other_code_are_kept_and_noticed(table, monkeypatch):
    assert not again(table).is_of_other_code
    monkeypatch.setattr("training.evaluation.measure.table.code_digest", lambda: "other")
    changed = again(table)
    assert changed.is_of_other_code
    assert not changed.lacks("P0", "a", "model", "123")


def test_photographs_are_grouped_by_a_column():
    rows = [row(name, kind=kind) for name, kind in zip("abc", ("z", "y", "z"), strict=True)]
    cases = Cases({"model": rows})
    assert cases.groups("kind") == {"y": [1], "z": [0, 2]}
    assert [one["photograph"] for one in cases.part([0, 2]).joined(cases.part([1])).first] == ["a", "c", "b"]


def test_errors_are_those_of_the_metrics():
    true, guess = ResponseCurve.gamma(1.8), ResponseCurve.gamma(2.2)
    counts = np.arange(256)
    figures = curve_figures(true, guess, counts)
    codes = np.arange(256) / 255
    assert figures["E_est"] == pytest.approx(estimation_error(true, guess), abs=1e-6)
    assert figures["E_lin"] == pytest.approx(100 * linearization_error(codes, true, guess, counts=counts), abs=1e-4)
    assert figures["shape"] == pytest.approx(shape_error(true, guess), abs=1e-6)
    gap = (true.brightness - guess.brightness)[true.brightness <= 0.8]
    assert figures["lower"] == pytest.approx(np.sqrt(1024 * np.mean(gap**2)), abs=1e-6)


def test_the_lower_part_of_a_response_may_be_scaled_to_fit():
    """The estimate clips a third of a stop too early, and is right otherwise."""
    true = ResponseCurve.gamma(2.2)
    early = ResponseCurve.from_samples(np.minimum(UNIFORM * 1.26, 1) ** (1 / 2.2))
    figures = curve_figures(true, early, np.arange(256))
    assert figures["lower"] > 1
    assert figures["partial"] < 0.05
