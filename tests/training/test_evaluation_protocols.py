import csv
import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")
pytest.importorskip("PIL", reason="training needs the train extra")
pytest.importorskip("matplotlib", reason="training needs the train extra")

from crfnet_core.errors import CRFNetError
from training.evaluation.__main__ import main
from training.evaluation.bootstrap import Resampling
from training.evaluation.cases import CaseFile
from training.evaluation.material import SceneFile, bundled_material
from training.evaluation.plan import plain_shots
from training.evaluation.protocols import Evaluation, Model, Settings
from training.evaluation.real import measure_real, real_cases
from training.evaluation.tables import Sheet, other_kind_table


@pytest.fixture
def model(fixed_model):
    return Model.found(str(fixed_model))


def evaluation(model, tmp_path, *, material=None, **settings):
    return Evaluation(Settings(tmp_path, (model,), workers=1, **settings), material or bundled_material())


def test_a_model_is_found_by_name_or_by_folder(fixed_model):
    assert Model.found("crfnet2017").name == "crfnet2017"
    assert Model.found(str(fixed_model)).name == "fixed_model"
    with pytest.raises(CRFNetError, match=r"nonesuch: is no model folder; .* one of .*crfnet2017"):
        Model.found("nonesuch")


def test_p2_refuses_a_model_that_may_know_its_curves(model, tmp_path):
    material = replace(bundled_material(), held_out=(1, 5))
    for known in ({}, {"held_out_curves": [1]}):
        asked = evaluation(replace(model, training=known), tmp_path, material=material, protocols=("p2",))
        with pytest.raises(CRFNetError, match="does not say that it was trained without the held-out curves"):
            asked.run()


def test_p2_measures_the_held_out_curves_alone(model, tmp_path):
    material = replace(bundled_material(), held_out=(1, 5))
    honest = replace(model, training={"held_out_curves": [1, 5, 7]})
    report = evaluation(honest, tmp_path, material=material, protocols=("p2",), photographs=4).run()
    assert (report["P2"]["photographs"], report["P2"]["curves"]) == (4, 2)


def test_two_models_of_one_name_are_refused(model, tmp_path):
    twice = Evaluation(Settings(tmp_path, (model, model)), bundled_material())
    with pytest.raises(CRFNetError, match="different names, found fixed_model, fixed_model"):
        twice.run()


def kinds_sheet(material):
    shots = plain_shots(range(len(material.scenes)), range(4), count=20, seed=1)
    scenes = np.array([shot.scene for shot in shots])
    columns = {"estimation": scenes + 1.0, "linearisation": (scenes + 1) / 100}
    curves = np.array([shot.curve for shot in shots])
    return Sheet(tuple(shots), {"m": columns, "gamma 2.2": columns}, Resampling.of(scenes, curves, seed=1))


@pytest.mark.parametrize(
    ("training", "kind", "is_strict", "mean"),
    [
        ({"scene_kinds": ["panorama"]}, "photograph", True, 1.5),
        ({"scene_kinds": ["photograph"]}, "panorama", True, 4.0),
        ({"scene_kinds": ["panorama", "photograph"]}, "photograph", False, 1.5),
        ({}, "photograph", False, 1.5),
    ],
)
def test_p1_takes_the_kind_that_training_did_not_see(tmp_path, training, kind, is_strict, mean):
    kinds = ["photograph", "photograph", "panorama", "panorama", "panorama"]
    scenes = tuple(SceneFile(f"s{k}", kind, tmp_path) for k, kind in enumerate(kinds))
    material = replace(bundled_material(), scenes=scenes)
    row = other_kind_table(kinds_sheet(material), {"m": training}, material)["m"]
    assert (row["kind"], row["is_strict"]) == (kind, is_strict)
    assert row["estimators"]["m"]["E_est mean"]["value"] == pytest.approx(mean)


def real_data(folder, root):
    """Two cameras: the bundled plate with its true response, graded A, and with gamma 1.8, graded C."""
    for name in ("input", "gt"):
        (folder / "real" / name).mkdir(parents=True)
    shutil.copy(root / "tests/data/plate.jpg", folder / "real/input/plate.jpg")
    shutil.copy(root / "tests/data/plate_response.csv", folder / "real/gt/one.csv")
    uniform = np.linspace(0, 1, 1024)
    table = np.stack([uniform, uniform ** (1 / 1.8)], axis=1)
    np.savetxt(folder / "real/gt/two.csv", table, delimiter=",", header="e,b", comments="")
    with (folder / "real/cases.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["id", "camera", "grade", "input_file"])
        writer.writerows([["one", "X1", "A", "input/plate.jpg"], ["two", "X2", "C", "input/plate.jpg"]])
    return folder


def test_p4_measures_real_photographs_by_camera(model, tmp_path, root):
    material = replace(bundled_material(), data=real_data(tmp_path / "data", root))
    report = evaluation(model, tmp_path / "out", material=material, protocols=("p4",)).run()["P4"]
    assert report["trusted"]["cameras"] == 1
    assert report["all"]["cameras"] == 2
    assert report["trusted"]["estimators"]["fixed_model"]["E_est mean"]["value"] < 0.02
    assert report["trusted"]["estimators"]["mean of the other cameras"]["E_est mean"]["value"] == pytest.approx(
        5.269, abs=2e-3
    )  # the other camera is gamma 1.8
    assert report["cameras"]["X2"]["estimators"]["fixed_model"]["E_est"] == pytest.approx(5.269, abs=0.01)
    assert (tmp_path / "out" / "p4-fixed_model.png").stat().st_size > 10_000


def test_real_photographs_are_measured_once(model, tmp_path, root, monkeypatch):
    cases = real_cases(real_data(tmp_path, root))
    files = {model.name: CaseFile.opened(tmp_path / "p4.json", {}, "c")}
    curves = bundled_material().curves
    measure_real(cases, {model.name: model.folder}, files, curves)
    before = json.dumps(files[model.name].rows)
    monkeypatch.setattr("training.evaluation.real.read_photo", lambda path: pytest.fail(f"{path} was read again"))
    measure_real(cases, {model.name: model.folder}, files, curves)
    assert json.dumps(files[model.name].rows) == before


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
