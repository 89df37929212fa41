"""Which responses are expected, and whether metadata counts, in Blender; estimates that an earlier version stored."""

import dataclasses

import numpy as np
import pytest

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")


@pytest.fixture
def image(addon, plate_file):
    return bpy.data.images.load(str(plate_file))


def stored(datablock):
    from blender_addon.scene.stored_estimate import restored

    return restored(datablock)


def assert_equal(found, expected):
    """Two estimates are the same, number by number."""
    np.testing.assert_equal(dataclasses.asdict(found), dataclasses.asdict(expected))


def test_the_prior_and_the_metadata_follow_the_settings(image, plate_file, estimate, tmp_path):
    from crfnet_core.posterior import Prior

    image.camera_response_settings.prior = "any"
    bpy.ops.crf.estimate_response(image=image.name, ignore_metadata=True)
    assert_equal(stored(image), estimate(plate_file, prior=Prior.load("any"), use_metadata=False))
    own = tmp_path / "mine.json"
    own.write_text('{"shares": {"film": 1}, "evidence": 1}')
    bpy.ops.crf.estimate_response(image=image.name, prior="file", prior_file=str(own), ignore_metadata=False)
    assert_equal(stored(image), estimate(plate_file, prior=Prior.load(own)))
    settings = image.camera_response_settings
    assert (settings.prior, settings.prior_file, settings.ignore_metadata) == ("file", str(own), False)


def test_what_took_the_plate_may_be_told(image, plate_file, estimate):
    from crfnet_core.photograph.metadata import Device

    bpy.ops.crf.estimate_response(image=image.name, device="phone")
    assert_equal(stored(image), estimate(plate_file, device=Device.PHONE))
    assert image.camera_response_settings.device == "phone"
    bpy.ops.crf.estimate_response(image=image.name, device="file")
    assert_equal(stored(image), estimate(plate_file))


def test_a_prior_without_its_file_is_told(image):
    with pytest.raises(RuntimeError, match="choose a Prior File"):
        bpy.ops.crf.estimate_response(image=image.name, prior="file")
    with pytest.raises(RuntimeError, match=r"none\.json: .*; choose another Prior File, or expect Camera"):
        bpy.ops.crf.estimate_response(image=image.name, prior="file", prior_file="/nowhere/none.json")
    assert "camera_response" not in image


def test_an_estimate_of_an_earlier_version_is_applied(image, tmp_path):
    """Layout 1 knew neither the expected shape error nor families, prior and metadata."""
    from blender_addon.scene.stored_estimate import is_stored

    bpy.ops.crf.estimate_response(image=image.name)
    entries = image["camera_response"].to_dict()
    for name in ("shape_uncertainty", "families", "prior", "metadata"):
        entries.pop(name)
    image["camera_response"] = {**entries, "layout": 1, "spread": 0.1}
    assert is_stored(image)
    brightness = stored(image).curve.brightness
    assert bpy.ops.crf.apply_response(image=image.name, apply="EXPORT", folder=str(tmp_path / "out")) == {"FINISHED"}
    np.testing.assert_array_equal(stored(image).curve.brightness, brightness)
    assert "nan" not in image["camera_response"]["lines"]
