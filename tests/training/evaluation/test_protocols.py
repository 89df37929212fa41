from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")
pytest.importorskip("PIL", reason="training needs the train extra")
pytest.importorskip("matplotlib", reason="training needs the train extra")

from crfnet_core.errors import CRFNetError
from crfnet_core.network import DEFAULT_MODEL
from training.evaluation.__main__ import main
from training.evaluation.measure.figures import PhotographFigures
from training.evaluation.plan import clean_photographs
from training.evaluation.protocols import Evaluation
from training.evaluation.report.content import MeasuredModel
from training.evaluation.report.document import read_report
from training.evaluation.settings import Model, Settings
from training.evaluation.summaries.bootstrap import Resampling
from training.evaluation.summaries.clean import other_kind_report
from training.evaluation.summaries.error_table import ErrorColumns, ErrorTable
from training.evaluation.test_sets import SceneFile, bundled_test_set


@pytest.fixture
def model(fixed_model):
    return Model.find(str(fixed_model))


def evaluation(model, tmp_path, *, test_set=None, **settings):
    return Evaluation(Settings(tmp_path, (model,), workers=1, **settings), test_set or bundled_test_set())


def trained_without(model, *held_out):
    return replace(model, measured=replace(model.measured, held_out_curves=held_out))


def test_a_model_is_found_by_name_or_by_folder(fixed_model):
    packaged = DEFAULT_MODEL.name
    assert Model.find(packaged).name == packaged
    assert Model.find(str(fixed_model)).name == "fixed_model"
    with pytest.raises(CRFNetError, match=rf"nonesuch: is no model folder; .* one of .*{packaged}"):
        Model.find("nonesuch")


def test_p2_refuses_a_model_that_may_know_its_curves(model, tmp_path):
    test_set = replace(bundled_test_set(), held_out=(1, 5))
    for held_out in ((), (1,)):
        asked = evaluation(trained_without(model, *held_out), tmp_path, test_set=test_set, protocols=("p2",))
        with pytest.raises(CRFNetError, match="does not say that it was trained without the held-out curves"):
            asked.run()


def test_p2_measures_the_held_out_curves_alone(model, tmp_path):
    test_set = replace(bundled_test_set(), held_out=(1, 5))
    honest = trained_without(model, 1, 5, 7)
    report = evaluation(honest, tmp_path, test_set=test_set, protocols=("p2",), photographs=4).run()
    assert (report.p2.overall.photographs, report.p2.curves) == (4, 2)
    assert report == read_report(tmp_path / "report.json")


def test_two_models_of_one_name_are_refused(model, tmp_path):
    twice = Evaluation(Settings(tmp_path, (model, model)), bundled_test_set())
    with pytest.raises(CRFNetError, match="different names, found fixed_model, fixed_model"):
        twice.run()


def kinds_table(test_set):
    photographs = clean_photographs(range(len(test_set.scenes)), range(4), count=20, seed=1)
    scenes = np.array([photograph.scene for photograph in photographs])
    curves = np.array([photograph.curve for photograph in photographs])
    rows = [PhotographFigures(scene + 1.0, (scene + 1) / 100, 0.1, 0.0) for scene in scenes]
    columns = {name: ErrorColumns.of(rows) for name in ("m", "gamma 2.2")}
    return photographs, ErrorTable(columns, Resampling.of(scenes, curves, seed=1))


@pytest.mark.parametrize(
    ("scene_kinds", "kind", "is_strict", "mean"),
    [
        (("panorama",), "photograph", True, 1.5),
        (("photograph",), "panorama", True, 4.0),
        (("panorama", "photograph"), "photograph", False, 1.5),
        (None, "photograph", False, 1.5),
    ],
)
def test_p1_takes_the_kind_that_training_did_not_see(tmp_path, scene_kinds, kind, is_strict, mean):
    kinds = ["photograph", "photograph", "panorama", "panorama", "panorama"]
    scenes = tuple(SceneFile(f"s{k}", kind, tmp_path) for k, kind in enumerate(kinds))
    test_set = replace(bundled_test_set(), scenes=scenes)
    models = {"m": MeasuredModel("hash", scene_kinds)}
    row = other_kind_report(*kinds_table(test_set), models, test_set)["m"]
    assert (row.group.kind, row.is_strict) == (kind, is_strict)
    assert row.group.estimators["m"].errors.estimation.mean.value == pytest.approx(mean)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "give --data, or --quick"),
        (["--quick", "--workers", "0"], "workers must be 1 or more"),
        (["--quick", "--protocol", "p4"], "p4 needs real photographs"),
        (["--quick", "--photographs", "0"], "photographs must be 1 or more"),
        (["--quick", "--lights", "nowhere", "--workers", "1"], "write the lights with"),
    ],
)
def test_mistakes_are_one_line(tmp_path, arguments, message):
    with pytest.raises(SystemExit, match=message) as leaving:
        main([*arguments, "--out", str(tmp_path)])
    assert "\n" not in str(leaving.value)
