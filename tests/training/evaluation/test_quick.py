"""The quick evaluation, from the command line to the report, on the bundled lights."""

import json

import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")
pytest.importorskip("PIL", reason="training needs the train extra")
pytest.importorskip("matplotlib", reason="training needs the train extra")

from crfnet_core.network import DEFAULT_MODEL
from crfnet_core.response.curve import LEAST_SLOPE
from training.evaluation.__main__ import main, parsed
from training.evaluation.measure import jobs
from training.evaluation.measure.jobs import Job
from training.evaluation.plan import CLEAN, Condition, Query
from training.evaluation.protocols import Evaluation
from training.evaluation.report.document import read_report
from training.evaluation.settings import Model, Settings
from training.evaluation.test_sets import bundled_test_set

#: Mean figures of `python -m training.evaluation --quick --protocol p0 --photographs 10`, by the head of the packaged
#: model's hash. A new model, or another pipeline: measure, look whether it got better, and write them down here.
EXPECTED = {
    "14fa0631c1d8": {"E_est mean": 1.6103, "E_lin mean": 3.6785, "E_est ratio": 0.7349, "shape mean": 0.2374},
}

#: What rounding on other processors may change: a few windows of a few photographs.
PLATFORM = 0.03


@pytest.fixture(scope="module")
def stressed(tmp_path_factory, fixed_model):
    """The report of the fixed model: P0, two conditions and four questions."""
    out = tmp_path_factory.mktemp("quick")
    settings = Settings(
        out,
        (Model.find(str(fixed_model)),),
        protocols=("p0", "p1", "p3"),
        photographs=15,
        workers=1,
        stress_photographs=3,
        conditions=(CLEAN, Condition("resolution 2x", upsampling=2), Condition("noise variance 4", noise=4.0)),
        queries=(
            Query("1 window", windows=1),
            Query("random windows", coverage=0),
            Query("none removed", averaged="all"),
            Query("2 photographs pooled", pooled=2),
        ),
    )
    return out, Evaluation(settings, bundled_test_set()).run()


def test_the_packaged_model_is_as_good_as_it_was(tmp_path):
    main(["--quick", "--out", str(tmp_path), "--protocol", "p0", "--photographs", "10", "--workers", "1"])
    report = read_report(tmp_path / "report.json")
    figures = report.p0.overall.estimators[DEFAULT_MODEL.name].named()
    found = {name: figures[name] for name in ("E_est mean", "E_lin mean", "E_est ratio", "shape mean")}
    sha256 = report.models[DEFAULT_MODEL.name].sha256[:12]
    assert sha256 in EXPECTED, f"a new model: write {sha256}: {found} into EXPECTED"
    assert found == pytest.approx(EXPECTED[sha256], abs=PLATFORM)


def test_a_model_that_answers_nearly_the_same(stressed):
    estimators = stressed[1].p0.overall.estimators
    fixed, gamma = estimators["fixed_model"].errors, estimators["gamma 2.2"].errors
    assert fixed.estimation.mean.value == pytest.approx(4.2, abs=0.8)
    assert fixed.estimation.p90.value > fixed.estimation.mean.value
    assert fixed.linearization.ratio.value > 1.2
    assert fixed.estimation.win_rate.value < 0.5
    assert gamma.estimation.mean.value == pytest.approx(2.192, abs=0.001)
    assert gamma.linearization.mean.value == pytest.approx(5.135, abs=0.01)
    assert gamma.estimation.ratio.value == gamma.shape.ratio.value == 1


def test_errors_are_those_of_the_fixed_curve(stressed, true_response):
    """What the cache holds is the distance of the true curve, which the label names, to the model's answer."""
    cases = json.loads((stressed[0] / "cases" / "fixed_model" / "p0.json").read_text())
    curves = bundled_test_set().curves
    for label, error in zip(cases["photographs"], cases["estimators"]["fixed_model"]["estimation"], strict=True):
        curve = int(label.split("curve ")[1].split(",")[0])
        distance = np.linalg.norm(curves[curve] - true_response.brightness)
        assert error == pytest.approx(distance, abs=1)  # the evidence moves, and the prior pulls


def test_stress_hardly_changes_a_model_that_hardly_looks(stressed):
    report = stressed[1].p3
    for row in [*report.conditions.values(), *report.queries.values()]:
        to_clean = row.estimators["fixed_model"].to_clean
        assert to_clean.estimation.ratio.value == pytest.approx(1, abs=0.1)
        assert to_clean.linearization.ratio.value == pytest.approx(1, abs=0.1)
        assert to_clean.shape.ratio.value == pytest.approx(1, abs=0.1)
    assert report.queries["1 window"].estimators["fixed_model"].to_clean.estimation.comparison.difference.value != 0
    assert list(report.queries) == ["1 window", "random windows", "none removed", "2 photographs pooled"]
    partial = report.partial["fixed_model"]
    assert partial.lower.value < partial.whole.value


def test_the_report_shows_the_paper_beside_ours(stressed):
    text = (stressed[0] / "report.md").read_text()
    assert "| *paper: CRF-net* | 1.607 |" in text
    assert "| noise variance 4 | 6.069 / 48.200 | 3.78 / 23.07 |" in text
    assert "this is not the strict protocol" in text
    assert "there are no such scenes here" in text
    assert {path.name for path in stressed[0].glob("*.png")} == {"p0.png", "p3.png", "p5.png", "p5-shape.png"}


def test_an_interrupted_evaluation_goes_on_and_ends_the_same(stressed, fixed_model, tmp_path, monkeypatch):
    def stop(job):
        if job.photographs[0].scene == 2:
            raise KeyboardInterrupt
        return run(job)

    run = jobs.run_job
    arguments = ["--quick", "--model", str(fixed_model), "--protocol", "p0", "--photographs", "15", "--workers", "1"]
    arguments += ["--out", str(tmp_path)]
    with monkeypatch.context() as patch:
        patch.setattr(jobs, "run_job", stop)
        with pytest.raises(KeyboardInterrupt):
            main(arguments)
    kept = json.loads((tmp_path / "cases" / "fixed_model" / "p0.json").read_text())["photographs"]
    assert len(kept) == 6
    taken = []
    with monkeypatch.context() as patch:
        photo = Job.photo
        patch.setattr(Job, "photo", lambda job, *which: taken.append(which) or photo(job, *which))
        main(arguments)
    assert len(taken) == 9
    assert read_report(tmp_path / "report.json").p0 == stressed[1].p0


def test_a_finished_evaluation_takes_no_photograph(stressed, fixed_model, monkeypatch):
    out, report = stressed
    before = {path.name: path.read_bytes() for path in out.glob("p0.png")}
    monkeypatch.setattr(Job, "photo", lambda *_: pytest.fail("a photograph was taken again"))
    arguments = ["--quick", "--model", str(fixed_model), "--photographs", "15", "--out", str(out)]
    main([*arguments, "--protocol", "p0", "p1"])
    assert read_report(out / "report.json").p0 == report.p0
    assert {path.name: path.read_bytes() for path in out.glob("p0.png")} == before


def test_pooled_photographs_show_other_scenes(monkeypatch, fixed_model, tmp_path):
    seen = []
    estimate = jobs.estimate_response
    monkeypatch.setattr(
        jobs,
        "estimate_response",
        lambda photos, **k: seen.append([p.path.name for p in photos]) or estimate(photos, **k),
    )
    settings = Settings(
        tmp_path,
        (Model.find(str(fixed_model)),),
        protocols=("p3",),
        workers=1,
        stress_photographs=1,
        conditions=(CLEAN,),
        queries=(Query("4 photographs pooled", pooled=4),),
    )
    Evaluation(settings, bundled_test_set()).run()
    single, pooled = sorted(seen, key=len)
    assert len(single) == 1
    assert len(set(pooled)) == 4
    assert pooled[0] == single[0]


def test_the_bundled_responses_are_strict_and_far_from_each_other():
    test_set = bundled_test_set()
    assert (np.diff(test_set.curves, axis=1) >= 0.9 * LEAST_SLOPE / 1024).all()
    distances = np.linalg.norm(test_set.curves[:, None] - test_set.curves, axis=2)
    assert distances[~np.eye(13, dtype=bool)].min() > 0.15
    assert np.log2(test_set.exposures()[:3]) == pytest.approx([-2.09, -2.55, -3.43], abs=0.01)


def test_the_command_line_says_what_is_measured(fixed_model, tmp_path):
    quick = parsed(["--quick", "--out", str(tmp_path), "--model", str(fixed_model), "crfnet2017"]).settings
    assert quick.protocols == ("p0", "p3")
    assert (quick.photographs, quick.stress_photographs, quick.workers, quick.seed) == (40, 5, 2, 2017)
    assert [model.name for model in quick.models] == ["fixed_model", "crfnet2017-1.4"]
