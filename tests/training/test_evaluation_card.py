import json
import shutil
import sys
from dataclasses import replace

import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")
pytest.importorskip("PIL", reason="training needs the train extra")
pytest.importorskip("matplotlib", reason="training needs the train extra")

from crfnet_core.errors import CRFNetError
from crfnet_core.network import ModelConfig
from training.evaluation.material import bundled_material
from training.evaluation.protocols import Evaluation, Model, Settings
from training.export import model_card as card


@pytest.fixture(scope="module")
def measured(tmp_path_factory, fixed_model):
    """A copy of the fixed model under its own name, and its report."""
    folder = tmp_path_factory.mktemp("card")
    shutil.copytree(fixed_model, folder / "fixed")
    settings = Settings(folder / "out", (Model.found(str(folder / "fixed")),), ("p0",), photographs=5, workers=1)
    report = Evaluation(settings, bundled_material()).run()
    path = folder / "report.json"
    path.write_text(json.dumps(report | {"notes": []}))  # as if measured on the data
    return folder / "fixed", path, report


def test_model_json_and_readme_get_the_figures(measured, monkeypatch):
    folder, path, report = measured
    monkeypatch.setattr(sys, "argv", ["card", "--model", str(folder), "--report", str(path)])
    card.main()
    figures = ModelConfig.read(folder / "model.json").accuracy["P0"]
    own = report["P0"]["estimators"]
    assert figures["E_est mean"] == own["fixed"]["E_est mean"]["value"]
    assert figures["E_est gamma 2.2"] == own["gamma 2.2"]["E_est mean"]["value"]
    assert figures["photographs"] == 5
    assert figures["band coverage"] == report["P5"]["P0"]["fixed"]["band coverage"]
    text = (folder / "README.md").read_text()
    assert text.startswith("# fixed\n")
    assert f"| E_est mean | {figures['E_est mean']:g} |" in text


def test_a_report_of_another_model_is_refused(measured):
    folder, path, _ = measured
    config = replace(ModelConfig.read(folder / "model.json"), sha256="0" * 64)
    with pytest.raises(CRFNetError, match="holds no figures of fixed 000000000000"):
        card.checked_report(path, config)


def test_a_report_on_bundled_material_is_refused(measured, tmp_path):
    folder, _, report = measured
    (tmp_path / "report.json").write_text(json.dumps(report))
    with pytest.raises(CRFNetError, match="is no whole evaluation on the data"):
        card.checked_report(tmp_path / "report.json", ModelConfig.read(folder / "model.json"))
