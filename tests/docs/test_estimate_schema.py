"""docs/estimate.schema.json describes every document of an estimate, and no other."""

import copy
import dataclasses
import json
import math

import numpy as np
import pytest

from crfnet.luts.files import WRITERS
from crfnet_core import AnalysisOptions, ResponseEstimate, ResponseNetwork, estimate_response, read_photo
from crfnet_core.estimate.result import SCHEMA_VERSION
from crfnet_core.files import json_text
from crfnet_core.library import CameraLibrary
from crfnet_core.photograph.metadata import Encoding, FileOrigin
from crfnet_core.photograph.metadata.devices import Device
from crfnet_core.photograph.metadata.origin import SHAPES
from crfnet_core.posterior import Family, Verdict
from tests.helpers.cameras import camera, photograph
from tests.helpers.schemas import problems_by, read_schema


@pytest.fixture(scope="module")
def schema():
    return read_schema("estimate")


@pytest.fixture(scope="module")
def problems(schema):
    return problems_by(schema)


@pytest.fixture(scope="module")
def estimate(plate, fixed_model):
    return estimate_response(
        read_photo(plate), network=ResponseNetwork.load(fixed_model), options=AnalysisOptions(windows=2)
    )


@pytest.fixture(scope="module")
def written(crfnet, plate, fixed_model, tmp_path_factory):
    """The file that the command writes, and what it prints."""
    folder = tmp_path_factory.mktemp("look")
    done = crfnet("estimate", plate, "--out", folder, "--model", fixed_model, "--no-sheet", "--json")
    return json.loads((folder / "plate.json").read_text(encoding="utf-8")), json.loads(done.out)["estimates"][0]


def test_what_the_command_writes_and_prints(written, problems):
    file, printed = written
    assert file == printed
    assert problems(file) == []


def test_the_sample(root, problems):
    assert problems(json.loads((root / "docs" / "sample" / "plate.json").read_text(encoding="utf-8"))) == []


def test_what_linearize_prints(crfnet, plate, fixed_model, tmp_path, problems):
    done = crfnet("linearize", plate, "--out", tmp_path / "a.exr", "--model", fixed_model, "--json")
    assert problems(json.loads(done.out)["estimate"]) == []


def test_what_a_stored_camera_says(crfnet, plate, fixed_model, tmp_path, problems, monkeypatch):
    monkeypatch.setenv("CRFNET_DATA_DIR", str(tmp_path / "data"))
    CameraLibrary.of_user().save(camera("a", make="SONY", model="ILCE-7M3"))
    photo = photograph(plate, tmp_path / "photo.jpg")
    model = ("--model", fixed_model, "--json")
    assert problems(json.loads(crfnet("camera", "show", "a", "--json").out)["estimate"]) == []
    for name, stored in (("own", ()), ("stored", ("--camera", "a"))):
        done = crfnet("estimate", photo, "--out", tmp_path / name, *stored, "--no-sheet", *model)
        (document,) = json.loads(done.out)["estimates"]
        assert problems(document) == []
        assert ("known_cameras" in document, document["camera"] is None) == ((not stored,) * 2)


def test_what_the_api_gives_is_what_the_command_writes(plate, fixed_model, written):
    """But for the sizes of the photographs and what the command made of the response."""
    api = estimate_response(read_photo(plate), network=ResponseNetwork.load(fixed_model)).to_dict()
    file = copy.deepcopy(written[0])
    for photo in file["photographs"]:
        assert {photo.pop(name) for name in ("width", "height", "bit_depth")} == {672, 378, 8}
        assert photo.pop("has_gain_map") is False
    for name in ("primaries", "exposure", "output_space", "color_space", "files"):
        del file[name]
    assert api == file
    assert ResponseEstimate.from_dict(written[0]).to_dict() == api


def test_an_estimate_of_which_little_is_known(estimate, problems):
    """As the add-on makes of a LUT."""
    bare = dataclasses.replace(
        *(estimate,), weights=np.zeros(0), windows=(), uncertainty=math.nan, shape_uncertainty=math.nan, families={}
    )
    bare = dataclasses.replace(bare, origins=(), photos=(), prior="", verdict=Verdict.DO_NOT_TRUST)
    assert problems(json.loads(json_text(bare.to_dict()))) == []


@pytest.mark.parametrize("change", [{"verdict": "splendid"}, {"schema_version": 2}, {"families": {"x": 1}}, {"new": 1}])
def test_a_wrong_entry_is_found(estimate, problems, change):
    """Otherwise the tests above could not fail."""
    assert problems(estimate.to_dict()) == []
    assert problems(estimate.to_dict() | change)


@pytest.mark.parametrize("name", ["verdict", "response", "windows", "schema_version"])
def test_an_absent_entry_is_found(estimate, problems, name):
    document = estimate.to_dict()
    del document[name]
    assert problems(document)


def test_it_names_the_code_s_own_choices(schema):
    entries, origin = schema["properties"], schema["$defs"]["origin"]["properties"]
    assert entries["schema_version"]["const"] == SCHEMA_VERSION
    assert schema["$id"].endswith(f":{SCHEMA_VERSION}")
    assert set(WRITERS) >= {f".{name}" for name in entries["files"]["required"][:3]}
    assert entries["verdict"]["enum"] == [*Verdict]
    assert entries["families"]["propertyNames"]["enum"] == [*Family]
    assert origin["device"]["enum"] == [*Device]
    assert origin["encoding"]["enum"] == [*Encoding]
    assert set(origin["picture_shape"]["enum"]) == {*SHAPES, "other"}
    assert set(origin) == {field.name for field in dataclasses.fields(FileOrigin)}
