"""An estimate as the entries of a .blend file, and back."""

import dataclasses
import json

import numpy as np
import pytest

from blender_addon.work.estimate_record import entries_of, estimate_of
from crfnet_core import ResponseNetwork, estimate_response, read_photo
from crfnet_core.errors import CurveError, Notice
from crfnet_core.estimate.result import CameraAnswer
from crfnet_core.photograph.metadata.devices import Device
from crfnet_core.photograph.recognition import Kind, Recognition
from crfnet_core.posterior import Family
from tests.helpers.refusals import refused

#: The entries of layout 2, with their types: a change needs a new layout.
SAVED = {
    **dict.fromkeys(("model", "photos", "verdict"), str),
    **dict.fromkeys(("uncertainty", "shape_uncertainty"), float),
    **dict.fromkeys(("families", "prior", "metadata", "recognition", "camera", "notices"), str),
    **dict.fromkeys(("weights", "brightness", "lower", "upper"), list),
    **{f"window_{name}": list for name in ("photos", "places", "weights", "errors", "kept")},
}


@pytest.fixture(scope="module")
def found(plate, fixed_model):
    """An estimate from two photographs, with warnings and with texts of any characters."""
    estimate = estimate_response([read_photo(plate)] * 2, network=ResponseNetwork.load(fixed_model))
    odd = dataclasses.replace(estimate.origins[0], editor='a "写真" \\ editor', words=("saved by 写真", "scaled"))
    return dataclasses.replace(
        estimate,
        origins=(odd, estimate.origins[1]),
        recognition=Recognition(Kind.LOG_FOOTAGE, "codes end at 16", 'give it "写真"', curves=("Sony S-Log3",)),
        camera=CameraAnswer("写真機", "measured from 6 exposures"),
        warnings=(Notice("edited", {"editor": "Photos"}), Notice("gray")),
    )


def test_an_estimate_comes_back_the_same(found):
    again = estimate_of(entries_of(found))
    np.testing.assert_equal(dataclasses.asdict(again), dataclasses.asdict(found))
    assert again.verdict is found.verdict
    assert {type(family) for family in again.families} == {Family}
    assert [type(origin.device) for origin in again.origins] == [Device, Device]
    assert again.recognition.kind is Kind.LOG_FOOTAGE


def test_the_entries_are_those_of_the_layout(found):
    """Their types exactly: a custom property must not learn of our enumerations, nor of numpy."""
    entries = entries_of(found)
    assert {name: type(entry) for name, entry in entries.items()} == SAVED
    assert {type(number) for entry in entries.values() if isinstance(entry, list) for number in entry} == {int, float}
    assert entries["verdict"] == found.verdict.value
    assert json.loads(entries["families"]) == found.families
    assert entries["prior"] == "camera"
    assert entries["photos"] == "plate.jpg\nplate.jpg"
    count = len(found.windows)
    assert [len(entries[f"window_{name}"]) for name in ("places", "weights")] == [4 * count, 11 * count]
    window = found.windows[0].window
    assert entries["window_places"][:4] == [window.x, window.y, window.step, window.filled]


def test_a_curve_that_was_tampered_with_is_refused(found):
    entries = entries_of(found)
    entries["brightness"][5] = 2.0
    with refused(CurveError, "curve_not_strict"):
        estimate_of(entries)
