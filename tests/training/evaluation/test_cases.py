import json

import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")
pytest.importorskip("PIL", reason="training needs the train extra")

from crfnet_core.errors import CRFNetError
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import estimation_error, linearization_error, shape_error
from training.evaluation.measure.case_files import CaseFile, code_digest
from training.evaluation.measure.figures import PhotographFigures, baseline_figures

SETTINGS = {"seed": 1, "sha256": "abc"}


def kept(path, code="c"):
    cases = CaseFile.opened(path, SETTINGS, code)
    cases.rows = {f"photograph {k}": {"model": figures(k)} for k in range(3)}
    cases.save()
    return cases


def figures(k):
    return PhotographFigures(k / 8, 0.1, 0.2, 0.3, uncertainty=1.5, coverage=0.9, curve=(0, k), band=((0, 0), (0, 1)))


def test_cases_come_back_in_the_order_asked_for(tmp_path):
    kept(tmp_path / "model" / "p0.json")
    cases = CaseFile.opened(tmp_path / "model" / "p0.json", SETTINGS, "c")
    assert cases.figures(["photograph 2", "photograph 0"]) == {"model": [figures(2), figures(0)]}
    assert not cases.is_of_other_code


def test_cases_of_other_settings_are_not_read(tmp_path):
    kept(tmp_path / "p0.json")
    assert CaseFile.opened(tmp_path / "p0.json", SETTINGS | {"sha256": "other"}, "c").rows == {}


def test_cases_of_other_figures_are_not_read(tmp_path):
    kept(tmp_path / "p0.json")
    document = json.loads((tmp_path / "p0.json").read_text())
    document["figures"].remove("shape")
    (tmp_path / "p0.json").write_text(json.dumps(document))
    assert CaseFile.opened(tmp_path / "p0.json", SETTINGS, "c").rows == {}


def test_baselines_keep_no_uncertainty(tmp_path):
    cases = CaseFile.opened(tmp_path / "p0.json", SETTINGS, "c")
    cases.rows = {"photograph": {"gamma 2.2": PhotographFigures(1.0, 0.1, 0.2, 0.3)}}
    cases.save()
    columns = json.loads((tmp_path / "p0.json").read_text())["estimators"]["gamma 2.2"]
    assert list(columns) == ["estimation", "linearization", "shape", "partial"]
    assert CaseFile.opened(tmp_path / "p0.json", SETTINGS, "c").rows == cases.rows


def test_cases_of_other_code_are_read_but_marked_for_ever(tmp_path):
    kept(tmp_path / "p0.json")
    changed = CaseFile.opened(tmp_path / "p0.json", SETTINGS, "d")
    assert changed.is_of_other_code
    assert len(changed.rows) == 3
    changed.save()
    assert json.loads((tmp_path / "p0.json").read_text())["code"] == "mixed"
    assert CaseFile.opened(tmp_path / "p0.json", SETTINGS, "d").is_of_other_code


def test_absent_photographs_are_named(tmp_path):
    with pytest.raises(CRFNetError, match="1 photographs are absent, the first: photograph 9"):
        kept(tmp_path / "p0.json").figures(["photograph 0", "photograph 9"])


def test_errors_are_those_of_the_metrics():
    true, guess = ResponseCurve.gamma(1.8), ResponseCurve.gamma(2.2)
    counts = np.arange(256)
    found = baseline_figures(true, guess, counts)
    codes = np.arange(256) / 255
    assert found.estimation == pytest.approx(estimation_error(true, guess), abs=1e-6)
    assert found.linearization == pytest.approx(linearization_error(codes, true, guess, counts=counts), abs=1e-6)
    assert found.shape == pytest.approx(shape_error(true, guess), abs=1e-6)
    assert found.errors.linearization == 100 * found.linearization
    lower = np.linspace(0, 1, 1024) <= 0.8 + 1e-3
    gap = true.brightness - guess.brightness
    assert found.partial == pytest.approx(np.linalg.norm(gap[lower]), abs=1e-3)
    assert found.partial < found.estimation


def test_the_digest_of_the_code_follows_the_code(tmp_path):
    assert code_digest() == code_digest()
    assert len(code_digest()) == 16
    module = tmp_path / "crfnet_core" / "posterior" / "prior.py"
    module.parent.mkdir(parents=True)
    digests = [code_digest(tmp_path)]
    for text in ("a = 1", "a = 2"):
        module.write_text(text)
        digests.append(code_digest(tmp_path))
    assert len(set(digests)) == 3
