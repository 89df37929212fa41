"""docs/calibrate.schema.json and docs/each.schema.json describe what the command prints and writes, no more."""

import dataclasses
import json
import shutil

import pytest

from crfnet.defaults import ESTIMATES
from crfnet.pipeline import PhotographRecord
from crfnet_core.posterior import Verdict
from tests.helpers.looks import write_look
from tests.helpers.schemas import problems_by, read_schema
from tests.helpers.stacks import StackOptions, light_of, make_stack


@pytest.fixture(scope="module")
def calibration(crfnet, root, true_response, tmp_path_factory):
    """What `crfnet calibrate` prints and writes: a LUT is compared; a plate of an earlier run is there."""
    folder = tmp_path_factory.mktemp("calibration")
    light = light_of(root / "tests" / "data" / "lights" / "interior.exr")[::4, ::4]
    frames = make_stack(folder, light, true_response, StackOptions(frames=6, quality=0))
    lut = root / "docs" / "sample" / "plate.spi1d"
    write_look(folder / "camera", ["b.jpg"])
    (folder / "camera" / "a.json").write_text("{}")
    given = ("--out", folder / "camera", "--name", "a", "--compare", lut, "--no-sheet", "--overwrite", "--json")
    done = crfnet("calibrate", *frames, *given)
    assert (done.code, done.err) == (0, "")
    return json.loads(done.out), json.loads((folder / "camera" / "a.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def each(crfnet, plate, fixed_model, tmp_path_factory):
    """What `crfnet estimate --each` and `linearize --each` print of two photographs, the second of which is bad."""
    folder = tmp_path_factory.mktemp("each")
    shutil.copy(plate, folder / "good.jpg")
    (folder / "bad.jpg").write_bytes(b"no photograph")
    again = ("--each", "--json", "--workers", "1", "--model", fixed_model, "--out", folder / "out", "--overwrite")
    photos = (folder / "good.jpg", folder / "bad.jpg")
    files = ("--no-sheet", "--no-linear")
    printed = json.loads(crfnet("estimate", *photos, *again, *files).out)
    linear = json.loads(crfnet("linearize", *photos, *again).out)
    lines = (folder / "out" / ESTIMATES).read_text(encoding="utf-8").splitlines()
    return printed, linear, [json.loads(line) for line in lines[-2:]]


def test_what_calibrate_prints_and_writes(calibration):
    problems = problems_by(read_schema("calibrate"))
    printed, written = calibration
    assert problems(printed) == []
    assert problems(written) == []
    assert printed == written | {"dropped": ["CRF b"]}
    assert printed["comparison"] is not None


@pytest.mark.parametrize(
    "change", [{"kind": "estimate"}, {"weights": []}, {"new": 1}, {"residual_codes": -1}, {"comparison": {}}]
)
def test_a_wrong_entry_of_a_calibration_is_found(calibration, change):
    """Otherwise the test above could not fail."""
    assert problems_by(read_schema("calibrate"))(calibration[0] | change)


def test_every_entry_of_a_calibration_is_required(calibration):
    schema = read_schema("calibrate")
    assert set(schema["required"]) == set(calibration[1])
    assert set(schema["properties"]) == set(calibration[0])


def test_what_each_prints(each):
    problems = problems_by(read_schema("each"))
    printed, linear, _ = each
    assert problems(printed) == []
    assert problems(linear) == []
    assert [bool(record["error"]) for record in printed["estimates"]] == [False, True]


def test_the_lines_of_a_manifest_are_records(each):
    schema = read_schema("each")
    problems = problems_by(schema["$defs"]["record"] | {"$defs": schema["$defs"]})
    assert [problems(record) for record in each[2]] == [[], []]


@pytest.mark.parametrize("change", [{"verdict": "splendid"}, {"exposure": "much"}, {"primaries": {}}, {"new": 1}])
def test_a_wrong_entry_of_a_record_is_found(each, change):
    printed = each[0]
    assert problems_by(read_schema("each"))(printed | {"estimates": [printed["estimates"][0] | change]})


def test_a_document_without_records_is_found(each):
    assert problems_by(read_schema("each"))({"folder": "out"})


def test_it_names_the_code_s_own_entries_and_choices():
    record = read_schema("each")["$defs"]["record"]
    assert record["required"] == [*record["properties"]]
    assert record["required"] == [field.name for field in dataclasses.fields(PhotographRecord)]
    assert record["properties"]["verdict"]["enum"] == [*Verdict, ""]
