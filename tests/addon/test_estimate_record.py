"""An estimate as the entries of a .blend file, and back."""

import dataclasses

import numpy as np
import pytest

from blender_addon.work.estimate_record import entries_of, estimate_of
from crfnet_core.errors import CurveError

#: The entries that version 0.1.0 of the add-on saved, with their types.
SAVED = {
    "model": str,
    "photos": str,
    "verdict": str,
    "uncertainty": float,
    "spread": float,
    "warnings": str,
    "weights": list,
    "brightness": list,
    "lower": list,
    "upper": list,
    "window_photos": list,
    "window_places": list,
    "window_weights": list,
    "window_errors": list,
    "window_kept": list,
}


@pytest.fixture(scope="module")
def found(plate, fixed_model):
    """An estimate from two photographs, with warnings."""
    from crfnet_core import ResponseNetwork, estimate_response, read_photo

    estimate = estimate_response([read_photo(plate)] * 2, network=ResponseNetwork.load(fixed_model))
    return dataclasses.replace(estimate, warnings=("one thing", "another"))


def test_an_estimate_comes_back_the_same(found):
    again = estimate_of(entries_of(found))
    np.testing.assert_equal(dataclasses.asdict(again), dataclasses.asdict(found))
    assert again.verdict is found.verdict


def test_an_estimate_without_warnings_has_none_afterwards(found):
    assert estimate_of(entries_of(dataclasses.replace(found, warnings=()))).warnings == ()


def test_the_entries_are_those_of_earlier_versions(found):
    """Their types exactly: a custom property must not learn of our enumerations, nor of numpy."""
    entries = entries_of(found)
    assert {name: type(entry) for name, entry in entries.items()} == SAVED
    assert {type(number) for entry in entries.values() if isinstance(entry, list) for number in entry} == {int, float}
    assert entries["verdict"] == "good"
    assert entries["photos"] == "plate.jpg\nplate.jpg"
    count = len(found.windows)
    assert [len(entries[f"window_{name}"]) for name in ("places", "weights")] == [4 * count, 11 * count]
    window = found.windows[0].window
    assert entries["window_places"][:4] == [window.x, window.y, window.step, window.filled]


def test_a_curve_that_was_tampered_with_is_refused(found):
    entries = entries_of(found)
    entries["brightness"][5] = 2.0
    with pytest.raises(CurveError, match="increase strictly"):
        estimate_of(entries)
