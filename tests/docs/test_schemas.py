import copy
import dataclasses
import json
import math
import shutil

import numpy as np
import pytest

from crfnet.defaults import ESTIMATES
from crfnet.luts.files import WRITERS
from crfnet.pipeline import PhotographRecord
from crfnet_core import ResponseEstimate, ResponseNetwork, estimate_response, read_photo
from crfnet_core.estimate.result import SCHEMA_VERSION
from crfnet_core.files import json_text
from crfnet_core.library import CameraLibrary
from crfnet_core.photograph.metadata import FileOrigin
from crfnet_core.photograph.metadata.devices import Device
from crfnet_core.photograph.metadata.origin import SHAPES, Encoding
from crfnet_core.photograph.recognition.recognition import Kind
from crfnet_core.posterior import Family, Verdict
from tests.helpers.cameras import camera, photograph
from tests.helpers.looks import write_look
from tests.helpers.schemas import problems_by, read_schema
from tests.helpers.stacks import StackOptions, light_of, make_stack

PROBLEMS = {name: problems_by(read_schema(name)) for name in ("estimate", "calibrate", "each")}


@pytest.fixture(scope="module")
def estimate(crfnet, plate, fixed_model, tmp_path_factory):
    """The document of an estimate that the command writes, which is the one that it prints."""
    folder = tmp_path_factory.mktemp("look")
    done = crfnet("estimate", plate, "--out", folder, "--model", fixed_model, "--no-sheet", "--json")
    document = json.loads((folder / "plate.json").read_text(encoding="utf-8"))
    assert document == json.loads(done.out)["estimates"][0]
    return document


@pytest.fixture(scope="module")
def calibration(crfnet, root, true_response, tmp_path_factory):
    """What `crfnet calibrate` prints, with a LUT to compare, and a lost plate; and what it writes."""
    folder = tmp_path_factory.mktemp("calibration")
    light = light_of(root / "tests" / "data" / "lights" / "interior.exr")[::4, ::4]
    frames = make_stack(folder, light, true_response, StackOptions(frames=6, quality=0))
    write_look(folder / "camera", ["b.jpg"])
    (folder / "camera" / "a.json").write_text("{}")
    lut = root / "docs" / "sample" / "plate.spi1d"
    options = ("--name", "a", "--compare", lut, "--no-sheet", "--overwrite", "--json")
    done = crfnet("calibrate", *frames, "--out", folder / "camera", *options)
    assert (done.code, done.err) == (0, "")
    written = json.loads((folder / "camera" / "a.json").read_text(encoding="utf-8"))
    printed = json.loads(done.out)
    assert printed == written | {"dropped": ["CRF b"]}
    return printed, written


@pytest.fixture(scope="module")
def each(crfnet, plate, fixed_model, tmp_path_factory):
    """What `estimate --each` and `linearize --each` print of two photographs, the second of which is bad."""
    folder = tmp_path_factory.mktemp("each")
    shutil.copy(plate, folder / "good.jpg")
    (folder / "bad.jpg").write_bytes(b"no photograph")
    again = ("--each", "--json", "--workers", "1", "--model", fixed_model, "--out", folder / "out", "--overwrite")
    photos, files = (folder / "good.jpg", folder / "bad.jpg"), ("--no-sheet", "--no-linear")
    crfnet("estimate", *photos, *again, *files, "--forward")
    printed = json.loads(crfnet("estimate", *photos, *again, *files).out)
    linear = json.loads(crfnet("linearize", *photos, *again).out)
    lines = (folder / "out" / ESTIMATES).read_text(encoding="utf-8").splitlines()
    return printed, linear, [json.loads(line) for line in lines[-2:]]


def test_estimates(root, estimate):
    sample = json.loads((root / "docs" / "sample" / "plate.json").read_text(encoding="utf-8"))
    assert [PROBLEMS["estimate"](document) for document in (estimate, sample)] == [[], []]


def test_estimates_of_linearize_and_of_stored_cameras(crfnet, plate, fixed_model, tmp_path, monkeypatch):
    monkeypatch.setenv("CRFNET_DATA_DIR", str(tmp_path / "data"))
    CameraLibrary.of_user().save(camera("a", make="SONY", model="ILCE-7M3"))
    photo = photograph(plate, tmp_path / "photo.jpg")
    model = ("--model", fixed_model, "--json")
    shown = json.loads(crfnet("camera", "show", "a", "--json").out)["estimate"]
    linearized = json.loads(crfnet("linearize", photo, "--out", tmp_path / "a.exr", *model).out)["estimate"]
    offered, stored = (
        json.loads(crfnet("estimate", photo, "--out", tmp_path / name, *options, "--no-sheet", *model).out)
        for name, options in (("offered", ()), ("stored", ("--camera", "a")))
    )
    documents = (shown, linearized, *offered["estimates"], *stored["estimates"])
    assert [PROBLEMS["estimate"](document) for document in documents] == [[]] * 4


def test_an_estimate_from_python_is_the_document_without_its_files(plate, fixed_model, estimate):
    api = estimate_response(read_photo(plate), network=ResponseNetwork.load(fixed_model)).to_dict()
    file = copy.deepcopy(estimate)
    for photo in file["photographs"]:
        assert {photo.pop(name) for name in ("width", "height", "bit_depth")} == {672, 378, 8}
        assert photo.pop("has_gain_map") is False
    for name in ("primaries", "exposure", "output_space", "color_space", "files"):
        del file[name]
    assert api == file
    assert ResponseEstimate.from_dict(estimate).to_dict() == api


def test_an_estimate_that_the_add_on_makes_of_a_lut(estimate):
    unknown = {"weights": np.zeros(0), "windows": (), "families": {}, "origins": (), "photos": (), "prior": ""}
    errors = {"uncertainty": math.nan, "shape_uncertainty": math.nan, "verdict": Verdict.DO_NOT_TRUST}
    bare = dataclasses.replace(ResponseEstimate.from_dict(estimate), **unknown, **errors)
    assert PROBLEMS["estimate"](json.loads(json_text(bare.to_dict()))) == []


def test_calibrations(calibration):
    assert [PROBLEMS["calibrate"](document) for document in calibration] == [[], []]
    schema = read_schema("calibrate")
    required, of_pairs = {*schema["required"], *schema["else"]["required"]}, {"method", *schema["then"]["required"]}
    assert (required, set(schema["properties"]) - of_pairs) == (set(calibration[1]), set(calibration[0]))


def test_each(each):
    printed, linear, lines = each
    assert [PROBLEMS["each"](document) for document in (printed, linear)] == [[], []]
    assert [bool(record["error"]) for record in printed["estimates"]] == [False, True]
    schema = read_schema("each")
    record = problems_by(schema["$defs"]["record"] | {"$defs": schema["$defs"]})
    assert [record(line) for line in lines] == [[], []]


WRONG = {
    "estimate": ({"verdict": "splendid"}, {"schema_version": 2}, {"families": {"x": 1}}, {"new": 1}),
    "calibrate": ({"kind": "estimate"}, {"weights": []}, {"residual_codes": -1}, {"comparison": {}}),
    "each": ({"verdict": "splendid"}, {"exposure": "much"}, {"primaries": {}}, {"new": 1}),
}


@pytest.mark.parametrize(("name", "change"), [(name, change) for name, changes in WRONG.items() for change in changes])
def test_a_wrong_entry_is_found(estimate, calibration, each, name, change):
    """Otherwise the tests above could not fail."""
    if name == "each":
        change = {"estimates": [each[0]["estimates"][0] | change]}
    document = {"estimate": estimate, "calibrate": calibration[0], "each": each[0]}[name]
    assert PROBLEMS[name](document | change)


def test_the_schemas_name_the_code_s_own_choices():
    schema, record = read_schema("estimate"), read_schema("each")["$defs"]["record"]
    entries, origin = schema["properties"], schema["$defs"]["origin"]["properties"]
    assert entries["schema_version"]["const"] == SCHEMA_VERSION
    assert schema["$id"].endswith(f":{SCHEMA_VERSION}")
    assert set(WRITERS) >= {f".{name}" for name in entries["files"]["required"][:3]}
    assert entries["verdict"]["enum"] == [*Verdict]
    assert entries["recognition"]["properties"]["kind"]["enum"] == [*Kind]
    assert entries["families"]["propertyNames"]["enum"] == [*Family]
    assert origin["device"]["enum"] == [*Device]
    assert origin["encoding"]["enum"] == [*Encoding]
    assert set(origin["picture_shape"]["enum"]) == {*SHAPES, "other"}
    assert set(origin) == {field.name for field in dataclasses.fields(FileOrigin)}
    assert record["required"] == [*record["properties"]]
    assert record["required"] == [field.name for field in dataclasses.fields(PhotographRecord)]
    assert record["properties"]["verdict"]["enum"] == [*Verdict, ""]
