import json
from dataclasses import replace

import pytest

from crfnet_core.errors import CRFNetError
from crfnet_core.network import DEFAULT_MODEL
from training.evaluation.__main__ import main, parsed
from training.evaluation.measure import simulated
from training.evaluation.measure.simulated import simulated_photo
from training.evaluation.plan import CLEAN, RESOLUTIONS, Condition, TestPhotograph
from training.evaluation.protocols import Evaluation, evaluate
from training.evaluation.report.document import read_report
from training.evaluation.test_sets import bundled_test_set

#: Mean figures of `python -m training.evaluation --quick --protocol p0 --photographs 10`, by the head of the packaged
#: model's hash. A new model, or another pipeline: measure, look whether it got better, and write them down here.
EXPECTED = {"14fa0631c1d8": {"E_est mean": 1.6195, "E_lin mean": 3.7092, "E_est ratio": 0.739, "shape mean": 0.2379}}

#: The change that rounding on other processors may make: a few windows of a few photographs.
PLATFORM = 0.03


@pytest.fixture(scope="module")
def stressed(tmp_path_factory, model):
    """The report of the fixed model: P0, and three conditions."""
    out = tmp_path_factory.mktemp("quick")
    conditions = (CLEAN, Condition("blur variance 2", blur=2.0), Condition("noise variance 4", noise=4.0))
    with pytest.MonkeyPatch.context() as patch:
        for module in ("plan", "protocols"):
            patch.setattr(f"training.evaluation.{module}.CONDITIONS", conditions)
        return out, evaluate(Evaluation(out, bundled_test_set(), (model,), ["p0", "paper"], 15, stressed=3, workers=1))


def test_the_packaged_model_is_as_good_as_it_was(tmp_path):
    main(["--quick", "--out", str(tmp_path), "--protocol", "p0", "--photographs", "10", "--workers", "1"])
    report = read_report(tmp_path / "report.json")
    row, sha256 = report.row("P0", DEFAULT_MODEL.name), report.models[DEFAULT_MODEL.name][:12]
    figures = {name: row[name][0] for name in ("E_est mean", "E_lin mean", "E_est ratio", "shape mean")}
    assert sha256 in EXPECTED, f"a new model: write {sha256}: {figures} into EXPECTED"
    assert figures == pytest.approx(EXPECTED[sha256], abs=PLATFORM)


def test_stress_hardly_changes_a_model_that_hardly_looks(stressed):
    rows = [row for row in stressed[1].rows if row["table"].startswith("paper") and row["estimator"] == "fixed_model"]
    assert len(rows) == 3
    for row in rows:
        assert [row[f"{error} x clean"][0] for error in ("E_est", "E_lin", "shape")] == pytest.approx([1] * 3, abs=0.1)
    assert rows[0]["partial mean"][0] < rows[0]["lower mean"][0]


def test_one_window_is_asked_alone_on_clean_photographs(stressed):
    names = [row["estimator"] for row in stressed[1].table("paper") if row["group"] == "clean"]
    assert names[:3] == ["fixed_model", "fixed_model, one chosen window", "fixed_model, one random window"]


def test_resolutions_are_area_means_of_an_original():
    test_set = bundled_test_set()
    test_set = replace(test_set, originals=test_set.scenes[:1])
    number, (usual, *_, full) = len(test_set.scenes), RESOLUTIONS
    small, large = (simulated_photo(test_set, TestPhotograph(number, 0, each)) for each in (usual, full))
    assert small.shape[:2] == tuple(side // 4 for side in large.shape[:2])
    assert test_set.digest == bundled_test_set().digest


def test_the_report_shows_every_table(stressed):
    text = (stressed[0] / "report.md").read_text()
    assert "bundled lights and formulas instead of the data" in text
    for title in ("## P0: known responses", "## The paper's experiments", "## P5: reliability"):
        assert title in text
    assert "## P4" not in text
    mean, low, high = stressed[1].row("P0", "fixed_model")["E_est mean"]
    assert "| P0: 15 photographs | E_est | ratio |" in text
    assert f"| fixed_model | {mean:.2f} [{low:.2f}, {high:.2f}] |" in text
    (line,) = (line for line in text.splitlines() if line.startswith("| noise variance 4: 3 photographs |"))
    assert line.endswith("| 6.07, 3.78 |")  # the paper


def test_an_interrupted_evaluation_goes_on_and_ends_the_same(stressed, fixed_model, tmp_path, monkeypatch):
    def stop(job):
        if job.photographs[0].scene == 2:
            raise KeyboardInterrupt
        return run(job)

    run = simulated.run_job
    arguments = ["--quick", "--model", str(fixed_model), "--protocol", "p0", "--photographs", "15", "--workers", "1"]
    arguments += ["--out", str(tmp_path)]
    with monkeypatch.context() as patch:
        patch.setattr(simulated, "run_job", stop)
        with pytest.raises(KeyboardInterrupt):
            main(arguments)
    lines = [json.loads(line) for line in (tmp_path / "photographs.jsonl").read_text().splitlines()[1:]]
    assert len({row["photograph"] for row in lines}) == 6
    taken = []
    with monkeypatch.context() as patch:
        photo = simulated.simulated_photo
        patch.setattr(simulated, "simulated_photo", lambda *which: taken.append(which) or photo(*which))
        main(arguments)
    assert len(taken) == 9
    assert read_report(tmp_path / "report.json").table("P0") == stressed[1].table("P0")


def test_the_command_line_chooses_what_is_measured(fixed_model, tmp_path):
    quick = parsed(["--quick", "--out", str(tmp_path), "--model", str(fixed_model), "crfnet2017"])
    assert quick.protocols == ("p0", "paper")
    assert (quick.photographs, quick.stressed, quick.workers) == (40, 5, 2)
    assert [model.name for model in quick.models] == ["fixed_model", "crfnet2017-2.0"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "give --data, or --quick"),
        (["--quick", "--workers", "0"], "workers must be 1 or more"),
        (["--quick", "--protocol", "p4"], "p4 needs real photographs"),
        (["--quick", "--photographs", "0"], "photographs must be 1 or more"),
        (["--quick", "--model", "nonesuch"], rf"nonesuch: not a model folder; .* one of .*{DEFAULT_MODEL.name}"),
    ],
)
def test_mistakes_are_one_line(tmp_path, arguments, message):
    with pytest.raises(SystemExit, match=message) as leaving:
        main([*arguments, "--out", str(tmp_path)])
    assert "\n" not in str(leaving.value)


@pytest.mark.parametrize("held_out", [(), (1,)])
def test_p2_refuses_a_model_that_may_know_its_curves(model, tmp_path, held_out):
    models, test_set = (replace(model, held_out_curves=held_out),), replace(bundled_test_set(), held_out=(1, 5))
    with pytest.raises(CRFNetError, match="does not list the held-out curves"):
        evaluate(Evaluation(tmp_path, test_set, models, ["p2"], photographs=1, stressed=1, workers=1))
