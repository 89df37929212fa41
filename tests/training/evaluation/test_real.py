"""P4 on made-up folders of real photographs."""

import csv
import shutil
from dataclasses import astuple, replace

import numpy as np
import pytest

scipy_io = pytest.importorskip("scipy.io", reason="training needs the train extra")
pytest.importorskip("PIL", reason="training needs the train extra")
pytest.importorskip("matplotlib", reason="training needs the train extra")

from crfnet_core.posterior import IN_CAMERA, Posterior, Prior
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import estimation_error, shape_error
from training.data.real.photographs import real_photographs
from training.data.response_bank import COUNTS
from training.evaluation.measure.case_files import CaseFile
from training.evaluation.measure.pooled import pooled_groups
from training.evaluation.measure.real import bank_without_fold, mean_of_other_bodies, measure_real
from training.evaluation.protocols import Evaluation
from training.evaluation.report.accuracy import accuracy, bodies_table
from training.evaluation.report.real.photographs import worst
from training.evaluation.settings import Model, Settings
from training.evaluation.test_sets import bundled_test_set

UNIFORM = np.linspace(0, 1, 1024)

#: Exponents of the measured responses.
POWERS = {"two": 1.8, "three": 1.4, "four": 2.6}

#: The ways in which P4 asks the fixed model.
WAYS = tuple(f"fixed_model{way}" for way in ("", ", EXIF lost", ", EXIF lost, kind told", ", metadata ignored"))

#: Columns of the list of data/real_bodies that say where a file comes from, and the name of an editor.
EXIF, EDITOR = ("exif_make", "exif_model", "exif_software", "original_size"), "Adobe Photoshop 23.1 (Macintosh)"


@pytest.fixture(scope="module")
def model(fixed_model):
    return Model.find(str(fixed_model))


@pytest.fixture(scope="module", autouse=True)
def small_banks():
    """Banks of a twentieth of the responses, for speed."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("training.data.response_bank.COUNTS", {family: n // 20 for family, n in COUNTS.items()})
        yield


@pytest.fixture
def data(tmp_path, root):
    """Real photographs that a test may change."""
    return write_data(tmp_path / "data", root)


@pytest.fixture(scope="module")
def measured_once(model, tmp_path_factory, root):
    """The folder of the report, and the report, of photographs that no test changes."""
    out = tmp_path_factory.mktemp("real")
    return out, measured(model, out, write_data(out / "data", root))


def write_data(folder, root):
    """Write real photographs: all are the bundled plate, "one" with its true response, the others with powers."""
    for name in ("real/input", "real/gt", "real_bodies/photos", "real_bodies/gt"):
        (folder / name).mkdir(parents=True)
    shutil.copy(root / "tests/data/plate.jpg", folder / "real/input/plate.jpg")
    shutil.copy(root / "tests/data/plate.jpg", folder / "real_bodies/photos/plate.jpg")
    shutil.copy(root / "tests/data/plate_response.csv", folder / "real/gt/one.csv")
    for name in ("two", "three"):
        write_response(folder / f"real/gt/{name}.csv", POWERS[name])
    for name in POWERS:
        write_response(folder / f"real_bodies/gt/{name}.csv", POWERS[name])
    write_rows(
        folder / "real/cases.csv",
        ["id", "camera", "grade", "input_file", "input_size"],
        [
            ["one", "Nikon D90", "A", "input/plate.jpg", "4288x2848"],
            ["two", "X2 (resized via Photoshop)", "B", "input/plate.jpg", "1000x750"],
            ["three", "X3", "C", "input/plate.jpg", "1024x768"],
        ],
    )
    (folder / "dorf").mkdir()
    scipy_io.savemat(folder / "dorf/201_CRF_data.mat", {"B": bundled_test_set().curves})
    photo = "photos/plate.jpg"
    write_rows(
        folder / "real_bodies/cases.csv",
        ["id", "body", "kind", "use", "grade", "file", "gt", "fold", *EXIF],
        [
            ["b1", "NIKON D90", "camera", "yes", "B", photo, "gt/three.csv", "0", "Nikon", "D90", "Ver.1", "2144x1424"],
            ["b2", "NIKON D90", "camera", "yes", "B", photo, "gt/four.csv", "0", "Nikon", "D90", "Ver.1", "640x480"],
            ["b3", "P1", "phone", "yes", "B", photo, "gt/four.csv", "1", "", "", "", "4032x3024"],
            ["b4", "P2", "phone", "caution: few frames", "C", photo, "gt/two.csv", "2", "P", "2", EDITOR, "4032x3024"],
        ],
    )
    return folder


def write_response(path, power):
    table = np.stack([UNIFORM, UNIFORM ** (1 / power)], axis=1)
    np.savetxt(path, table, delimiter=",", header="e,b", comments="")


def write_rows(path, header, rows):
    with path.open("w", newline="") as file:
        csv.writer(file).writerows([header, *rows])


def measured(model, out, data):
    test_set = replace(bundled_test_set(), data=data)
    return Evaluation(Settings(out, (model,), protocols=("p4",), workers=1), test_set).run()


def errors(summary, name):
    return summary.estimators[name].errors


def test_p4_means_are_over_bodies(measured_once):
    report = measured_once[1].p4
    assert list(report) == ["real", "real_bodies", "both"]
    real, bodies, both = report.values()
    assert [(part.trusted.bodies, part.trusted.photographs) for part in (real, bodies, both)] == [
        (2, 2),
        (2, 3),
        (3, 5),
    ]
    assert (real.everything.bodies, bodies.everything.bodies) == (3, 3)
    assert list(bodies.kinds) == ["camera", "phone"]
    assert [row.name for row in both.bodies] == [
        "Nikon D90",
        "X2 (resized via Photoshop)",
        "P1",
    ]  # one of them from two folders
    names = {name for difference in both.trusted.differences for name in (difference.first, difference.second)}
    assert names == {*WAYS, "mean of the other bodies"}
    three, four = (
        estimation_error(ResponseCurve.gamma(POWERS[k]), ResponseCurve.gamma(2.2)) for k in ("three", "four")
    )
    assert errors(bodies.trusted, "gamma 2.2").estimation.mean.value == pytest.approx(
        ((three + four) / 2 + four) / 2, abs=1e-3
    )


def test_p4_knows_the_model_and_the_mean_of_the_other_bodies(measured_once):
    report = measured_once[1].p4["real"]
    one = report.photographs[0]
    truth = ResponseCurve.gamma((POWERS["two"] + POWERS["three"]) / 2)  # by hand, from the other bodies of "one"
    expected = [metric(plate_response(measured_once[0] / "data"), truth) for metric in (estimation_error, shape_error)]
    found = one.estimators["mean of the other bodies"].errors
    assert (found.estimation, found.shape) == pytest.approx(expected, abs=5e-3)
    assert {path.name for path in measured_once[0].glob("*.png")} == {
        "p4-real-fixed_model.png",
        "p4-real_bodies-fixed_model.png",
        "p5.png",
        "p5-shape.png",
    }


def test_p4_answers_by_the_evidence_of_the_model_and_the_bank_of_the_other_bodies(measured_once):
    """The fixed model states the response of "one", so that its evidence brings that answer nearer and others away."""
    data = measured_once[0] / "data"
    nearer = []
    for case, row in zip(real_photographs(data)["real"][:2], measured_once[1].p4["real"].photographs, strict=False):
        prior_alone = Posterior.from_evidences(bank_without_fold(case, data), Prior.load()).curve
        found = row.estimators["fixed_model, metadata ignored"].errors.estimation
        nearer.append(estimation_error(case.truth(), prior_alone) - found)
    assert nearer[0] > 1
    assert nearer[1] < -1


def plate_response(data):
    return ResponseCurve.from_samples(np.loadtxt(data / "real/gt/one.csv", delimiter=",", skiprows=1)[:, 1])


def test_the_mean_leaves_out_the_fold_and_counts_a_body_once(data):
    photographs = real_photographs(data)["real_bodies"]
    truths = {photograph.measured: photograph.truth() for photograph in photographs}
    of_first, _, of_phone, of_careful = (
        mean_of_other_bodies(photograph, photographs, truths) for photograph in photographs
    )
    assert estimation_error(of_first, ResponseCurve.gamma(POWERS["four"])) < 0.02  # the phone alone
    between = ResponseCurve.gamma((POWERS["three"] + POWERS["four"]) / 2)
    assert estimation_error(of_phone, between) < 0.02  # the mean of the two stacks of the camera
    powers = [np.mean([POWERS["three"], POWERS["four"]]), POWERS["four"]]
    assert estimation_error(of_careful, ResponseCurve.gamma(np.mean(powers))) < 0.02  # camera and phone


def test_photographs_that_need_caution_are_shown_apart(measured_once):
    report = measured_once[1].p4
    assert [row.name for row in report["both"].photographs if row.caution] == ["three", "b4"]
    assert {row.caution for row in report["real_bodies"].photographs} == {"", "few frames"}
    text = (measured_once[0] / "report.md").read_text()
    careful = text.split("### Photographs that need caution")[1]
    assert "| b4 | P2 | phone |" in careful
    assert "| edited | no | few frames |" in careful
    assert "| b3 |" not in careful
    assert [row.name for row in report["real_bodies"].bodies] == ["NIKON D90", "P1"]


def test_p4_tells_where_the_files_come_from(measured_once):
    report = measured_once[1].p4
    counts = {name: group.photographs for name, group in report["both"].origins.items()}
    assert counts == {"edited": 1, "no editor named": 2, "not known": 2, "not scaled": 3, "scaled": 2}
    counts = {name: group.photographs for name, group in report["both"].origins_of_everything.items()}
    assert counts == {"edited": 2, "no editor named": 2, "not known": 3, "not scaled": 4, "scaled": 3}


def test_the_worst_photographs_come_first(measured_once):
    rows = measured_once[1].p4["both"].photographs
    shapes = [row.estimators["fixed_model"].errors.shape for row in worst(rows, "fixed_model")]
    assert shapes == sorted((row.estimators["fixed_model"].errors.shape for row in rows), reverse=True)
    text = (measured_once[0] / "report.md").read_text()
    first = worst(rows, "fixed_model")[0]
    assert text.index("largest shape errors of fixed_model") < text.index(f"| {first.name} | {first.body} |")


def test_without_the_folder_of_more_bodies_its_tables_are_left_out(model, tmp_path, data):
    shutil.rmtree(data / "real_bodies")
    report = measured(model, tmp_path / "out", data)
    assert (list(report.p4), list(report.p5["shape"])) == (["real"], ["P4 real"])
    text = (tmp_path / "out/report.md").read_text()
    assert "### data/real: responses of grade A and B: 2 photographs of 2 bodies" in text
    assert "data/real_bodies" not in text


def test_model_json_gets_the_figures_of_every_set(measured_once):
    report = measured_once[1]
    figures = accuracy(report, "fixed_model")
    assert list(figures) == ["P4 real", "P4 real_bodies", "P4 both"]
    both = report.p4["both"].trusted
    found = figures["P4 both"]
    assert (found["photographs"], found["bodies"]) == (5, 3)
    assert found["shape mean"] == errors(both, "fixed_model").shape.mean.value
    assert found["shape mean of the other bodies"] == errors(both, "mean of the other bodies").shape.mean.value
    assert "| Nikon D90 | AB | 3 |" in bodies_table(report, "fixed_model")


def test_real_photographs_are_measured_once(model, tmp_path, data, monkeypatch):
    photographs = real_photographs(data)["real"]
    files = {model.name: CaseFile.opened(tmp_path / "p4.json", {}, "c")}
    curves = bundled_test_set().curves
    measure_real(photographs, {model.name: model.folder}, files, curves, data)
    before = {label: astuple(row[model.name]) for label, row in files[model.name].rows.items()}
    monkeypatch.setattr(
        "training.evaluation.measure.real.read_photo", lambda path: pytest.fail(f"{path} was read again")
    )
    measure_real(photographs, {model.name: model.folder}, files, curves, data)
    assert {label: astuple(row[model.name]) for label, row in files[model.name].rows.items()} == before


def test_p4_asks_with_the_metadata_of_the_file_after_its_loss_and_without_any(measured_once):
    """The plate has no EXIF: this too says something, and only where it counts do the answers differ."""
    report = measured_once[1]
    assert all(set(WAYS) < set(part.trusted.estimators) for part in report.p4.values())
    answers = [report.p4["both"].photographs[0].estimators[way] for way in WAYS]
    assert answers[0].uncertainty != answers[2].uncertainty
    assert {answer.verdict for answer in answers} <= {"good", "usable", "do not trust"}
    text = (measured_once[0] / "report.md").read_text()
    assert text.count("| **fixed_model, metadata ignored** |") >= len(report.p4)
    assert set(report.p5["shape"]["P4 both"]) == set(WAYS)
    assert report.p5["shape"]["P4 both"]["fixed_model"].mean_error == pytest.approx(
        np.mean(
            [row.estimators["fixed_model"].errors.shape for row in report.p4["both"].photographs if not row.caution]
        ),
        abs=1e-3,
    )


def test_several_photographs_of_a_body_are_pooled(measured_once):
    """Only the camera of data/real_bodies has two photographs; its two stacks have different responses."""
    report = measured_once[1].p4
    assert report["real"].pooled == {}
    (group,) = report["both"].pooled
    summary = report["both"].pooled[group]
    assert (group, summary.bodies, summary.photographs) == ("2 to 4 photographs", 1, 2)
    single, pooled = (errors(summary, name).shape.mean.value for name in ("fixed_model", "fixed_model, pooled"))
    assert pooled == pytest.approx(single, abs=0.02)  # the same photograph twice
    text = (measured_once[0] / "report.md").read_text()
    assert "| 2 to 4 photographs | 1 | 2 | fixed_model, pooled |" in text


def test_at_most_four_photographs_are_pooled_from_all_over_the_list(data):
    first = real_photographs(data)["real_bodies"][0]
    many = [replace(first, name=str(number)) for number in range(8)]
    assert [[one.name for one in group] for group in pooled_groups(many)] == [["0", "2", "5", "7"]]
    assert pooled_groups(many[:1]) == []


def test_the_bank_of_a_photograph_knows_nothing_of_its_fold(data):
    """A response that no camera has is in the bank of the others, and not in that of its own fold."""
    write_response(data / "real/gt/two.csv", 9.0)
    one, two, _ = real_photographs(data)["real"]
    brightest = [
        max(bank.brightness[bank.members(family), 10].max() for family in IN_CAMERA)
        for bank in (bank_without_fold(photograph, data) for photograph in (one, two))
    ]
    assert brightest[0] > brightest[1] + 0.1
