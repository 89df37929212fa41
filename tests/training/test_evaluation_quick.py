"""The quick evaluation, from the command line to the report, on the bundled lights."""

import hashlib
import json

import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")
pytest.importorskip("PIL", reason="training needs the train extra")
pytest.importorskip("matplotlib", reason="training needs the train extra")

from crfnet_core.errors import CRFNetError
from crfnet_core.network import DEFAULT_MODEL
from crfnet_core.response import LEAST_SLOPE
from training.data.scenes import LUMINANCE
from training.data.studio_lights import BAND, LIGHTS, LIGHTS_FOLDER, copy_lights, read_light
from training.evaluation.__main__ import main, parsed
from training.evaluation.material import bundled_material
from training.evaluation.measure import Job
from training.evaluation.plan import CLEAN, Condition, Trial
from training.evaluation.protocols import Evaluation, Model, Settings

#: Mean figures of `python -m training.evaluation --quick --protocol p0 --photographs 10`, by the head of the packaged
#: model's hash. A new model, or another pipeline: measure, look whether it got better, and write them down here.
EXPECTED = {
    "e9616d175b37": {"E_est mean": 1.5931, "E_lin mean": 3.9224, "E_est ratio": 0.727},
}

#: What rounding on other processors may change: a few windows of a few photographs.
PLATFORM = 0.03


@pytest.fixture(scope="module")
def stressed(tmp_path_factory, fixed_model):
    """The report of the fixed model: P0, two conditions and four questions."""
    out = tmp_path_factory.mktemp("quick")
    settings = Settings(
        out,
        (Model.found(str(fixed_model)),),
        protocols=("p0", "p1", "p3"),
        photographs=15,
        workers=1,
        stress_photographs=3,
        conditions=(CLEAN, Condition("resolution 2x", upsampling=2), Condition("noise variance 4", noise=4.0)),
        trials=(
            Trial("1 window", windows=1),
            Trial("random windows", coverage=0),
            Trial("none removed", averaged="all"),
            Trial("2 photographs pooled", pooled=2),
        ),
    )
    return out, Evaluation(settings, bundled_material()).run()


def value(row, name):
    return row[name]["value"]


def test_the_packaged_model_is_as_good_as_it_was(tmp_path):
    main(["--quick", "--out", str(tmp_path), "--protocol", "p0", "--photographs", "10", "--workers", "1"])
    report = json.loads((tmp_path / "report.json").read_text())
    figures = report["P0"]["estimators"][DEFAULT_MODEL.name]
    found = {name: value(figures, name) for name in ("E_est mean", "E_lin mean", "E_est ratio")}
    sha256 = report["models"][DEFAULT_MODEL.name]["sha256"][:12]
    assert sha256 in EXPECTED, f"a new model: write {sha256}: {found} into EXPECTED"
    assert found == pytest.approx(EXPECTED[sha256], abs=PLATFORM)


def test_a_model_that_answers_nearly_the_same(stressed):
    figures = stressed[1]["P0"]["estimators"]
    fixed = {
        name: value(figures["fixed_model"], name) for name in ("E_est mean", "E_est p90", "E_lin mean", "E_lin ratio")
    }
    assert fixed == pytest.approx(
        {"E_est mean": 4.223, "E_est p90": 7.358, "E_lin mean": 8.517, "E_lin ratio": 1.659}, abs=0.01
    )
    assert value(figures["fixed_model"], "E_est win rate") == pytest.approx(2 / 15, abs=1e-4)
    assert value(figures["gamma 2.2"], "E_est mean") == pytest.approx(2.192, abs=0.001)
    assert value(figures["gamma 2.2"], "E_lin mean") == pytest.approx(5.135, abs=0.01)
    assert value(figures["gamma 2.2"], "E_est ratio") == 1


def test_errors_are_those_of_the_fixed_curve(stressed, true_response):
    """What the cache holds is the distance of the true curve, which the label names, to the model's answer."""
    cases = json.loads((stressed[0] / "cases" / "fixed_model" / "p0.json").read_text())
    curves = bundled_material().curves
    for label, error in zip(cases["photographs"], cases["estimators"]["fixed_model"]["estimation"], strict=True):
        curve = int(label.split("curve ")[1].split(",")[0])
        distance = np.linalg.norm(curves[curve] - true_response.brightness)
        assert error == pytest.approx(distance, abs=0.25)  # which moves by up to 0.5 a unit


def test_stress_hardly_changes_a_model_that_hardly_looks(stressed):
    table = stressed[1]["P3"]
    for row in [*table["conditions"].values(), *table["trials"].values()]:
        assert value(row["fixed_model"], "E_est to clean") == pytest.approx(1, abs=0.02)
        assert value(row["fixed_model"], "E_lin to clean") == pytest.approx(1, abs=0.1)
    assert value(table["trials"]["1 window"]["fixed_model"], "E_est difference") != 0
    assert list(table["trials"]) == ["1 window", "random windows", "none removed", "2 photographs pooled"]
    partial = table["partial"]["fixed_model"]
    assert value(partial, "E_est, E <= 0.8") < value(partial, "E_est")


def test_the_report_shows_the_paper_beside_ours(stressed):
    text = (stressed[0] / "report.md").read_text()
    assert "| *paper: CRF-net* | 1.607 |" in text
    assert "| noise variance 4 | 6.069 / 48.200 | 3.78 / 23.07 |" in text
    assert "this is not the strict protocol" in text
    assert "there are no such scenes here" in text
    assert {path.name for path in stressed[0].glob("*.png")} == {"p0.png", "p3.png", "p5.png"}


def test_an_interrupted_evaluation_goes_on_and_ends_the_same(stressed, fixed_model, tmp_path, monkeypatch):
    def stop(job):
        if job.shots[0].scene == 2:
            raise KeyboardInterrupt
        return run(job)

    from training.evaluation import measure

    run = measure.run_job
    arguments = ["--quick", "--model", str(fixed_model), "--protocol", "p0", "--photographs", "15", "--workers", "1"]
    arguments += ["--out", str(tmp_path)]
    with monkeypatch.context() as patch:
        patch.setattr(measure, "run_job", stop)
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
    assert json.loads((tmp_path / "report.json").read_text())["P0"] == stressed[1]["P0"]


def test_a_finished_evaluation_takes_no_photograph(stressed, fixed_model, monkeypatch):
    out, report = stressed
    before = {path.name: path.read_bytes() for path in out.glob("p0.png")}
    monkeypatch.setattr(Job, "photo", lambda *_: pytest.fail("a photograph was taken again"))
    arguments = ["--quick", "--model", str(fixed_model), "--photographs", "15", "--out", str(out)]
    main([*arguments, "--protocol", "p0", "p1"])
    assert json.loads((out / "report.json").read_text())["P0"] == report["P0"]
    assert {path.name: path.read_bytes() for path in out.glob("p0.png")} == before


def test_pooled_photographs_show_other_scenes(monkeypatch, fixed_model, tmp_path):
    seen = []
    from training.evaluation import measure

    estimate = measure.estimate_response
    monkeypatch.setattr(
        measure,
        "estimate_response",
        lambda photos, **k: seen.append([p.path.name for p in photos]) or estimate(photos, **k),
    )
    settings = Settings(
        tmp_path,
        (Model.found(str(fixed_model)),),
        protocols=("p3",),
        workers=1,
        stress_photographs=1,
        conditions=(CLEAN,),
        trials=(Trial("4 photographs pooled", pooled=4),),
    )
    Evaluation(settings, bundled_material()).run()
    single, pooled = sorted(seen, key=len)
    assert len(single) == 1
    assert len(set(pooled)) == 4
    assert pooled[0] == single[0]


def test_the_lights_are_those_of_blender():
    for light in LIGHTS:
        assert hashlib.sha256((LIGHTS_FOLDER / light.file).read_bytes()).hexdigest() == light.sha256
    assert sum(path.stat().st_size for path in LIGHTS_FOLDER.glob("*.exr")) < 2_500_000
    assert {light.file for light in LIGHTS}.isdisjoint({"sunrise.exr", "sunset.exr", "night.exr"})


def test_a_light_is_the_middle_of_its_panorama():
    scene = read_light(LIGHTS_FOLDER / "studio.exr")
    assert BAND == (0.1, 0.9)
    assert scene.pixels.shape == (410, 1024, 3)
    luminance = scene.pixels @ LUMINANCE
    assert np.exp(np.log(luminance[luminance > 0]).mean()) == pytest.approx(1, rel=1e-3)


def test_lights_are_copied_as_they_are_or_refused(tmp_path):
    copy_lights(LIGHTS_FOLDER, tmp_path)
    assert (tmp_path / "README.md").read_text() == (LIGHTS_FOLDER / "README.md").read_text()
    (tmp_path / "city.exr").write_bytes(b"other")
    with pytest.raises(CRFNetError, match=r"is not the file of Blender 4\.5"):
        copy_lights(tmp_path, tmp_path)


def test_the_bundled_responses_are_strict_and_far_from_each_other():
    material = bundled_material()
    assert (np.diff(material.curves, axis=1) >= 0.9 * LEAST_SLOPE / 1024).all()
    distances = np.linalg.norm(material.curves[:, None] - material.curves, axis=2)
    assert distances[~np.eye(13, dtype=bool)].min() > 0.15
    assert np.log2(material.exposures()[:3]) == pytest.approx([-2.09, -2.55, -3.43], abs=0.01)


def test_the_command_line_says_what_is_measured(fixed_model, tmp_path):
    quick = parsed(["--quick", "--out", str(tmp_path), "--model", str(fixed_model), "crfnet2017"]).settings
    assert quick.protocols == ("p0", "p3")
    assert (quick.photographs, quick.stress_photographs, quick.workers, quick.seed) == (40, 5, 2, 2017)
    assert [model.name for model in quick.models] == ["fixed_model", "crfnet2017"]
