import shutil
import sys
from dataclasses import replace

import pytest

from crfnet_core.errors import CRFNetError
from crfnet_core.network import ModelConfig
from training.evaluation.models import Model
from training.evaluation.protocols import Evaluation, evaluate
from training.evaluation.report.document import write_report
from training.evaluation.test_sets import bundled_test_set
from training.export import model_card


@pytest.fixture(scope="module")
def measured(tmp_path_factory, fixed_model):
    """A copy of the fixed model under its own name, and its report."""
    folder = tmp_path_factory.mktemp("card")
    shutil.copytree(fixed_model, folder / "fixed")
    models = (Model.find(str(folder / "fixed")),)
    report = evaluate(Evaluation(folder / "out", bundled_test_set(), models, ["p0"], 5, stressed=0, workers=1))
    path = folder / "report.json"
    write_report(path, replace(report, notes=[]))  # as if measured on the data
    return folder / "fixed", path, report


def test_model_json_and_readme_get_the_figures(measured, monkeypatch):
    folder, path, report = measured
    monkeypatch.setattr(sys, "argv", ["card", "--model", str(folder), "--report", str(path)])
    model_card.main()
    figures = ModelConfig.read(folder / "model.json").accuracy["P0"]
    own, gamma = (report.row("P0", name) for name in ("fixed", "gamma 2.2"))
    estimation, shape = (report.row(f"P5 {error}", "fixed", "P0") for error in ("E_est", "shape"))
    assert figures["E_est mean"] == own["E_est mean"][0]
    assert figures["shape p90"] == own["shape p90"][0]
    assert figures["E_est gamma 2.2"] == gamma["E_est mean"][0]
    assert figures["photographs"] == 5
    assert figures["band coverage"] == shape["band coverage"]
    assert figures["expected E_est rank correlation"] == estimation["rank correlation"]
    text = (folder / "README.md").read_text()
    assert text.startswith("# fixed\n")
    assert f"| E_est mean | {figures['E_est mean']:g} |" in text


def test_a_report_of_another_model_is_refused(measured):
    folder, path, _ = measured
    config = replace(ModelConfig.read(folder / "model.json"), sha256="0" * 64)
    with pytest.raises(CRFNetError, match="holds no figures of fixed 000000000000"):
        model_card.checked_report(path, config)


def test_a_report_on_the_bundled_test_set_is_refused(measured, tmp_path):
    folder, _, report = measured
    write_report(tmp_path / "report.json", report)
    with pytest.raises(CRFNetError, match="not a whole evaluation on the data"):
        model_card.checked_report(tmp_path / "report.json", ModelConfig.read(folder / "model.json"))
