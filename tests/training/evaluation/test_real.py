import csv
import json
import shutil
from dataclasses import replace

import numpy as np
import pytest
import scipy.io

from crfnet_core.estimate.estimate import estimate_response
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.photograph.image_io import read_photo
from crfnet_core.photograph.metadata import FileMetadata
from crfnet_core.response.curve import UNIFORM, ResponseCurve
from crfnet_core.response.metrics import estimation_error
from training.data.real_photographs import real_photographs
from training.data.response_bank import COUNTS
from training.evaluation.measure.real import WAYS, cached_bank, mean_of_other_bodies, without_exif
from training.evaluation.models import load_network
from training.evaluation.protocols import Evaluation, evaluate
from training.evaluation.test_sets import bundled_test_set
from training.export.model_card import accuracy, bodies_table

#: Exponents of the measured responses.
POWERS = {"two": 1.8, "three": 1.4, "four": 2.6}

#: The ways in which P4 asks the fixed model, by name.
ASKED = [f"fixed_model{way}" for way in WAYS]

#: Columns of the list of data/real_bodies that hold the origin of a file, and the name of an editor.
EXIF, EDITOR = ("exif_make", "exif_model", "exif_software", "original_size"), "Adobe Photoshop 23.1 (Macintosh)"


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
    scipy.io.savemat(folder / "dorf/201_CRF_data.mat", {"B": bundled_test_set().curves})
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
    return evaluate(Evaluation(out, test_set, (model,), ["p4"], photographs=1, stressed=1, workers=1))


def counts(report, table):
    """Bodies and photographs of the first estimator of a table."""
    row = report.table(table)[0]
    return row["bodies"], row["photographs"]


def photographs(out, **columns):
    """The rows of the table on disk with these columns."""
    rows = [json.loads(line) for line in (out / "photographs.jsonl").read_text().splitlines()[1:]]
    return [row for row in rows if columns.items() <= row.items()]


def test_p4_means_are_over_bodies(measured_once):
    report = measured_once[1]
    assert [counts(report, f"P4 {name}") for name in ("real", "real_bodies", "both")] == [(2, 2), (2, 3), (3, 5)]
    assert [counts(report, f"P4 {name}, with caution")[0] for name in ("real", "real_bodies")] == [3, 3]
    assert {row["group"] for row in report.table("P4 real_bodies by kind")} == {"camera", "phone"}
    bodies = [row["group"] for row in report.table("P4 both by body") if row["estimator"] == "gamma 2.2"]
    assert bodies == ["Nikon D90", "X2 (resized via Photoshop)", "P1"]  # one of them from two folders
    compared = {row["estimator"] for row in report.table("P4 both") if "shape difference" in row}
    assert compared == {*ASKED[1:], "mean of the other bodies"}
    three, four = (
        estimation_error(ResponseCurve.gamma(POWERS[k]), ResponseCurve.gamma(2.2)) for k in ("three", "four")
    )
    mean = report.row("P4 real_bodies", "gamma 2.2")["E_est mean"][0]
    assert mean == pytest.approx(((three + four) / 2 + four) / 2, abs=1e-3)


def test_p4_answers_by_the_evidence_of_the_model_and_the_bank_of_the_other_bodies(measured_once, model):
    out, data = measured_once[0], measured_once[0] / "data"
    for case in real_photographs(data)["real"][:2]:
        bank, options = cached_bank(data, without=case.fold), AnalysisOptions(use_metadata=False)
        photo, network = read_photo(case.photograph), load_network(model)
        answer = estimate_response(photo, network=network, bank=bank, options=options)
        (row,) = photographs(out, photograph=case.name, estimator="fixed_model, metadata ignored")
        assert row["E_est"] == pytest.approx(estimation_error(case.truth(), answer.curve), abs=1e-6)


def test_the_mean_leaves_out_the_fold_and_counts_a_body_once(data):
    cases = real_photographs(data)["real_bodies"]
    truths = {photograph.measured: photograph.truth() for photograph in cases}
    of_first, _, of_phone, of_careful = (mean_of_other_bodies(photograph, cases, truths) for photograph in cases)
    assert estimation_error(of_first, ResponseCurve.gamma(POWERS["four"])) < 0.02  # the phone alone
    between = ResponseCurve.gamma((POWERS["three"] + POWERS["four"]) / 2)
    assert estimation_error(of_phone, between) < 0.02  # the mean of the two stacks of the camera
    powers = [np.mean([POWERS["three"], POWERS["four"]]), POWERS["four"]]
    assert estimation_error(of_careful, ResponseCurve.gamma(np.mean(powers))) < 0.02  # camera and phone


def test_without_the_folder_of_more_bodies_its_tables_are_absent(model, tmp_path, data):
    shutil.rmtree(data / "real_bodies")
    report = measured(model, tmp_path / "out", data)
    assert {row["table"].split(",")[0].split(" by")[0] for row in report.rows} == {"P4 real", "P5 E_est", "P5 shape"}
    assert report.table("P4 real, pooled") == []  # no body has two photographs


def test_model_json_gets_the_figures_of_every_set(measured_once):
    report = measured_once[1]
    figures = accuracy(report, "fixed_model")
    assert list(figures) == ["P4 real", "P4 real_bodies", "P4 both"]
    both = figures["P4 both"]
    assert (both["photographs"], both["bodies"]) == (5, 3)
    assert both["shape mean"] == report.row("P4 both", "fixed_model")["shape mean"][0]
    others = report.row("P4 both", "mean of the other bodies")
    assert both["shape mean of the other bodies"] == others["shape mean"][0]
    assert "| Nikon D90 | AB | 3 |" in bodies_table(report, "fixed_model")


def test_real_photographs_are_measured_once(model, tmp_path, data, monkeypatch):
    report = measured(model, tmp_path / "out", data)
    monkeypatch.setattr(
        "training.evaluation.measure.real.read_photo", lambda path: pytest.fail(f"{path} was read again")
    )
    assert measured(model, tmp_path / "out", data) == report


def test_p4_asks_with_the_metadata_of_the_file_after_its_loss_and_without_any(measured_once):
    """The plate has no EXIF: this too is evidence, and only where it counts do the answers differ."""
    out, report = measured_once
    answers = [photographs(out, protocol="P4 real", photograph="one", estimator=way)[0] for way in ASKED]
    assert answers[0]["expected E_est"] != answers[2]["expected E_est"]
    stated = [row["group"] for row in report.table("P5 shape") if row["estimator"] == ASKED[3]]
    assert stated == ["P4 real", "P4 real_bodies", "P4 both"]
    shapes = [
        row["shape"]
        for folder in ("real", "real_bodies")
        for row in photographs(out, protocol=f"P4 {folder}", estimator="fixed_model", caution="")
    ]
    assert report.row("P5 shape", "fixed_model", "P4 both")["error mean"] == pytest.approx(np.mean(shapes), abs=1e-3)


def test_several_photographs_of_a_body_are_pooled(measured_once):
    """Only the camera of data/real_bodies has two photographs; its two stacks have different responses."""
    report = measured_once[1]
    table = "P4 both, pooled"
    assert counts(report, table) == (1, 2)
    assert {row["group"] for row in report.table(table)} == {"2 to 4 photographs"}
    single, pooled = (
        report.row(table, name, "2 to 4 photographs")["shape mean"][0] for name in (ASKED[0], f"{ASKED[0]}, pooled")
    )
    assert pooled == pytest.approx(single, abs=0.02)  # the same photograph twice


def test_a_file_that_lost_its_exif_keeps_the_size_of_its_picture_only(root):
    taken = FileMetadata(width=6000, height=4000, make="Canon", model="Canon EOS 6D", software="Adobe Photoshop")
    photo = read_photo(root / "tests" / "data" / "plate.jpg").with_metadata(taken)
    height, width = photo.pixels.shape[:2]
    assert without_exif(photo).metadata == FileMetadata(width=width, height=height, file_format="WebP")
    assert without_exif(photo).pixels is photo.pixels
