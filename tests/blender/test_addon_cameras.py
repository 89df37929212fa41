"""A stored camera in Blender: listed, used, remembered, and refused if it is not there."""

import dataclasses

import numpy as np
import pytest

from tests.helpers.cameras import camera, photograph

from .helpers import apply, bpy, drawn_in, estimate, labels, load, operators, stored_estimate


@pytest.fixture
def curve(monkeypatch, tmp_path):
    """The response of the stored camera "mine"."""
    from crfnet_core.library import CameraLibrary

    monkeypatch.setenv("CRFNET_DATA_DIR", str(tmp_path / "data"))
    mine = camera("mine", 2.0, make="SONY", model="ILCE-7M3")
    CameraLibrary.of_user().save(mine)
    return mine.curve


def test_a_chosen_camera_is_the_answer_and_is_remembered(image, curve):
    bpy.ops.crf.estimate_response(image=image.name, camera="mine")
    found = stored_estimate.restored(image)
    np.testing.assert_array_equal(found.curve.brightness, curve.brightness)
    assert found.camera.name == "mine"
    assert image.camera_response_settings.camera == "mine"
    _, details, _ = stored_estimate.panel_paragraphs(image)
    assert any("6 exposures" in line for line in details)


def test_a_camera_that_is_not_there_is_refused(image, curve):
    with pytest.raises(RuntimeError, match="choose another Camera under Advanced, or none"):
        bpy.ops.crf.estimate_response(image=image.name, camera="nobody")
    assert "camera_response" not in image


def test_the_stored_cameras_are_suggested(image, curve):
    from blender_addon.ui.plate_settings import _stored_cameras

    assert ("mine", "measured from 6 exposures") in _stored_cameras(image.camera_response_settings, bpy.context, "MI")


def test_without_the_wheels_none_are_suggested_and_nothing_breaks(image, monkeypatch):
    from blender_addon import lazy_import
    from blender_addon.ui.plate_settings import _stored_cameras
    from blender_addon.work.errors import AddonError

    def fail(module):
        raise AddonError("crfnet_core cannot be loaded")

    monkeypatch.setattr(lazy_import, "load", fail)
    assert _stored_cameras(image.camera_response_settings, bpy.context, "") == []


@pytest.fixture
def of_that_model(addon, plate_file, tmp_path):
    """A plate of the stored camera's make and model."""
    return load(photograph(plate_file, tmp_path / "sony.jpg"))


def test_the_best_camera_of_the_plate_s_model_is_offered_and_used_at_a_press(of_that_model, curve, in_editor):
    from crfnet_core.library import CameraLibrary

    worse = camera("a", make="SONY", model="ILCE-7M3")
    CameraLibrary.of_user().save(dataclasses.replace(worse, shape_stops=0.06))
    bpy.ops.crf.estimate_response(image=of_that_model.name)
    (name, words), (other, _) = stored_estimate.offers(of_that_model)
    assert (name, other, words) == ("mine", "a", "mine: measured from 6 exposures")
    drawn = drawn_in(of_that_model, in_editor)
    assert "was measured from 6 exposures. Others: Advanced > Camera." in " ".join(labels(drawn))
    assert [text for _, text in operators(drawn) if text.startswith("Use ")] == ["Use mine"]
    bpy.ops.crf.estimate_response(image=of_that_model.name, camera=name)
    assert stored_estimate.offers(of_that_model) == []
    assert stored_estimate.camera(of_that_model) == "mine"
    bpy.ops.crf.estimate_response(image=of_that_model.name, camera="")
    assert stored_estimate.camera(of_that_model) == ""
    assert of_that_model.camera_response_settings.camera == ""


def test_the_offer_stays_when_the_estimate_is_applied(of_that_model, curve, tmp_path):
    estimate(of_that_model)
    before = stored_estimate.offers(of_that_model)
    apply(of_that_model, "EXPORT", folder=str(tmp_path / "out"), anyway=True)
    assert stored_estimate.offers(of_that_model) == before != []


def test_nothing_is_offered_for_other_models_or_without_metadata(image, of_that_model, curve):
    bpy.ops.crf.estimate_response(image=image.name)
    bpy.ops.crf.estimate_response(image=of_that_model.name, ignore_metadata=True)
    assert stored_estimate.offers(image) == stored_estimate.offers(of_that_model) == []
