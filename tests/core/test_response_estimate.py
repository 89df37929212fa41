import dataclasses
import json
import math
from copy import deepcopy

import numpy as np
import pytest

from crfnet_core.errors import CRFNetError, EstimateError, Notice, PhotoError
from crfnet_core.estimate.estimate import estimate_response
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.estimate.result import SCHEMA_VERSION, CameraAnswer, ResponseEstimate
from crfnet_core.network import ResponseNetwork
from crfnet_core.photograph.image_io import read_photo
from crfnet_core.photograph.metadata import FileMetadata, file_origin
from crfnet_core.photograph.metadata.devices import Device
from crfnet_core.photograph.recognition import Kind, Recognition
from crfnet_core.posterior import Family, Verdict
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.refusals import refused


@pytest.fixture(scope="module")
def estimate(plate, fixed_model):
    found = estimate_response(
        [read_photo(plate)] * 2, network=ResponseNetwork.load(fixed_model), options=AnalysisOptions(windows=2)
    )
    origin = file_origin(FileMetadata(make="Canon", model="Canon EOS 20D", software='a "写真" editor'))
    return dataclasses.replace(
        found, warnings=(Notice("edited", {"editor": "Photos"}), Notice("gray")), origins=(*found.origins, origin)
    )


#: For each field another value.
CHANGES = {
    "curve": ResponseCurve.gamma(2.0),
    "weights": np.zeros(11),
    "windows": (),
    "uncertainty": 9.0,
    "shape_uncertainty": math.nan,
    "band": np.zeros((2, 1024)),
    "families": {Family.FILM: 1.0},
    "verdict": Verdict.DO_NOT_TRUST,
    "prior": "any",
    "origins": (),
    "warnings": (),
    "model": "other",
    "photos": ("a.jpg",),
    "recognition": Recognition(Kind.LIMITED_RANGE, "reason", "advice"),
    "camera": CameraAnswer("a", basis="measured"),
}


def test_equal_estimates_are_equal(estimate):
    assert estimate == deepcopy(estimate)
    assert estimate.windows[0] == deepcopy(estimate).windows[0]
    assert estimate != "estimate"


@pytest.mark.parametrize("field", [field.name for field in dataclasses.fields(ResponseEstimate)])
def test_estimates_differ_in_any_field(estimate, field):
    assert estimate != dataclasses.replace(deepcopy(estimate), **{field: CHANGES[field]})


def test_estimates_cannot_be_hashed_and_curves_can(estimate):
    with pytest.raises(TypeError, match="unhashable"):
        hash(estimate)
    curves = {estimate.curve: 1, ResponseCurve.gamma(2.2): 2}
    assert curves[deepcopy(estimate).curve] == 1
    assert curves[ResponseCurve.gamma(2.2)] == 2
    assert ResponseCurve.gamma(2.2) != ResponseCurve.gamma(2.21)
    assert ResponseCurve.gamma() != "curve"


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
    ("change", "code"),
    [
        ({"schema_version": SCHEMA_VERSION + 1}, "other_schema"),
        ({"response": {}}, "estimate_lacks"),
        ({"verdict": "splendid"}, "damaged_estimate"),
        ({"families": {"daguerreotype": 1}}, "damaged_estimate"),
        ({"weights": [10**400] * 11}, "damaged_estimate"),
        ({"uncertainty": True}, "damaged_estimate"),
        ({"windows": 3}, "damaged_estimate"),
        ({"families": []}, "damaged_estimate"),
        ({"estimates": []}, "list_of_estimates"),
    ],
)
def test_a_damaged_document_is_refused(estimate, change, code):
    with refused(EstimateError, code):
        ResponseEstimate.from_dict(estimate.to_dict() | change)


@pytest.mark.parametrize("document", [{}, [], "text", None])
def test_another_document_is_refused(document):
    with refused(EstimateError, "not_an_estimate"):
        ResponseEstimate.from_dict(document)


@pytest.mark.parametrize("given", ["plate.jpg", np.zeros((300, 300, 3), np.float32), ["plate.jpg"], 3])
def test_an_argument_that_is_not_a_photograph_is_refused(given, fixed_model):
    with refused(PhotoError, "not_a_photo"):
        estimate_response(given, network=ResponseNetwork.load(fixed_model))


@pytest.mark.parametrize(
    ("choices", "code"),
    [
        ({"options": AnalysisOptions(seed=-1)}, "in_file"),
        ({"prior": "any"}, "not_a_prior"),
        ({"options": AnalysisOptions(device="nokia")}, "not_a_device"),
    ],
)
def test_options_that_cannot_be_are_refused(plate, fixed_model, choices, code):
    with refused(CRFNetError, code):
        estimate_response(read_photo(plate), network=ResponseNetwork.load(fixed_model), **choices)
