import dataclasses
import json
import math
from copy import deepcopy

import numpy as np
import pytest

from crfnet_core import AnalysisOptions, ResponseCurve, ResponseNetwork, estimate_response, read_photo
from crfnet_core.errors import CRFNetError, EstimateError, Notice, PhotoError
from crfnet_core.estimate.result import SCHEMA_VERSION, ResponseEstimate
from crfnet_core.photograph.metadata import FileMetadata, file_origin
from crfnet_core.photograph.metadata.devices import Device
from crfnet_core.posterior import Family
from tests.helpers.refusals import refusal_of, refused


@pytest.fixture(scope="module")
def estimate(plate, fixed_model):
    found = estimate_response(
        [read_photo(plate)] * 2, network=ResponseNetwork.load(fixed_model), options=AnalysisOptions(windows=2)
    )
    origin = file_origin(FileMetadata(make="Canon", model="Canon EOS 20D", software='a "写真" editor'))
    return dataclasses.replace(
        found, warnings=(Notice("edited", {"editor": "Photos"}), Notice("gray")), origins=(*found.origins, origin)
    )


def test_estimates_are_equal_unless_they_differ_in_a_field(estimate):
    copy = deepcopy(estimate)
    assert (copy, copy.windows[0]) == (estimate, estimate.windows[0])
    assert estimate != "estimate"
    others = {"curve": ResponseCurve.gamma(2.0), "weights": np.zeros(11), "band": np.zeros((2, 1024))}
    for field in dataclasses.fields(ResponseEstimate):
        assert estimate != dataclasses.replace(copy, **{field.name: others.get(field.name, math.nan)}), field.name


def test_estimates_cannot_be_hashed_and_curves_can(estimate):
    with pytest.raises(TypeError, match="unhashable"):
        hash(estimate)
    curves = {estimate.curve, ResponseCurve.gamma(2.2)}
    assert curves == {deepcopy(estimate).curve, ResponseCurve.gamma(2.2)}
    assert curves.isdisjoint({ResponseCurve.gamma(2.21), "curve"})


def test_an_estimate_comes_back_from_json(estimate):
    document = json.loads(json.dumps(estimate.to_dict(), allow_nan=False))
    assert document == estimate.to_dict()
    again = ResponseEstimate.from_dict(document)
    assert again == estimate
    assert isinstance(again.origins[-1].device, Device)
    assert {type(family) for family in again.families} == {Family}
    assert again.verdict is estimate.verdict


def test_what_is_not_known_is_null(estimate):
    unknown = dataclasses.replace(estimate, uncertainty=math.nan, shape_uncertainty=math.nan, families={}, origins=())
    document = json.loads(json.dumps(unknown.to_dict(), allow_nan=False))
    assert (document["uncertainty"], document["uncertainty_percent"], document["family"]) == (None, None, None)
    assert ResponseEstimate.from_dict(document) == unknown


def test_what_a_later_version_adds_is_left_out(estimate):
    document = estimate.to_dict()
    document["new"] = document["windows"][0]["new"] = document["metadata"][0]["new"] = 1
    assert ResponseEstimate.from_dict(document) == estimate


@pytest.mark.parametrize(
    ("document", "code"),
    [
        *((document, "not_an_estimate") for document in ({"new": 1}, [1], "text", None)),
        *(({"schema_version": version}, "other_schema") for version in (SCHEMA_VERSION + 1, True)),
        *(({"schema_version": SCHEMA_VERSION}, "estimate_lacks"), ({"estimates": []}, "list_of_estimates")),
    ],
)
def test_another_document_is_refused(document, code):
    assert refusal_of(EstimateError, ResponseEstimate.from_dict, document).code == code


#: Entries of a document, and values that they do not have.
DAMAGES: dict[str, tuple[object, ...]] = {
    "photographs": ({}, "x", [], [{"name": 5}], ["a.jpg"]),
    "verdict": ("splendid", None),
    **dict.fromkeys(("uncertainty", "shape_uncertainty_stops"), (True, -5, math.nan, math.inf, 1e308, "1", [])),
    "families": ([], {"daguerreotype": 1}, {"phone": 0.5}, {"phone": 1.5}, {"phone": None}, {"phone": True}),
    "recognition": ("x", {"kind": "flat frame"}, {"kind": "flat frame", "reason": "", "advice": "", "errors": ["1"]}),
    "camera": ("x", [], {"name": 5, "basis": ""}),
    **dict.fromkeys(("prior", "model"), (None, 1, [], math.nan)),
    "metadata": ({}, [{}]),
    **dict.fromkeys(("metadata.0.device", "metadata.0.is_scaled", "metadata.0.words"), ("sundial", 1, [1])),
    "warnings": ("x", {}, [1]),
    "response": (None, np.ones(3)),
    "weights": (None, 1, [], [0.0] * 10, [[0.0] * 11], *([each] * 11 for each in (10**400, math.nan, "1", True))),
    "windows": (3, {}, [3]),
    **dict.fromkeys(("windows.0.photo", "windows.0.x", "windows.0.weights"), (-1, 1.5, "1", None)),
    **{"windows.0.filled": (257, -1), "windows.0.step": (0,)},
    **{"windows.0.kept": (1,), "windows.0.expected_error": (-1,)},
    "response.lower": ([1.0] * 1024,),  # above the upper end
    **dict.fromkeys(("response.brightness", "response.upper"), (None, [0.5] * 7, [2.0] * 1024, ["0.5"] * 1024)),
}


@pytest.mark.parametrize("place", DAMAGES)
def test_a_damaged_entry_is_refused(estimate, place):
    *folders, name = place.split(".")
    for value in DAMAGES[place]:
        document = entry = estimate.to_dict()
        for folder in folders:
            entry = entry[int(folder) if isinstance(entry, list) else folder]
        entry[name] = value
        assert refusal_of(EstimateError, ResponseEstimate.from_dict, document).code == "damaged_estimate"


@pytest.mark.parametrize("given", ["plate.jpg", np.zeros((300, 300, 3), np.float32), ["plate.jpg"], 3])
def test_arguments_that_are_not_photographs_are_refused(given, fixed_model):
    for photos, code in ((given, "not_a_photo"), ([], "no_photographs")):
        with refused(PhotoError, code):
            estimate_response(photos, network=ResponseNetwork.load(fixed_model))


OPTIONS = [(field.name, value) for field in dataclasses.fields(AnalysisOptions) for value in (-1, "a", 1.5, math.nan)]


@pytest.mark.parametrize(("option", "value"), [*OPTIONS, ("windows", 0), ("windows", True), ("coverage", 257)])
def test_options_of_another_type_or_out_of_range_are_refused(option, value):
    with refused(CRFNetError, "bad_option", name=option):
        AnalysisOptions(**{option: value})


def test_options_are_kept_as_values_of_their_types():
    options = AnalysisOptions(windows=np.int64(3), device="phone", use_metadata=np.False_)
    assert (options.windows, type(options.windows), options.device, type(options.device)) == (3, int, "phone", Device)
    assert options.use_metadata is False
    assert FileMetadata(width=np.int64(3), history=["a"]) == FileMetadata(width=3, history=("a",))


@pytest.mark.parametrize(
    "choice", [{"options": {}}, {"options": []}, {"prior": "any"}, {"bank": 0}, {"network": "crfnet"}, {"progress": 1}]
)
def test_an_argument_of_another_kind_is_refused(plate, fixed_model, choice):
    with refused(CRFNetError, "argument_kind", name=next(iter(choice))):
        estimate_response(read_photo(plate), **{"network": ResponseNetwork.load(fixed_model)} | choice)
