"""Which responses are expected, and whether metadata counts, in Blender; estimates that an earlier version stored."""

import dataclasses

import numpy as np
import pytest

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")


def stored(datablock):
    from blender_addon.scene.stored_estimate import restored

    return restored(datablock)


def assert_equal(found, expected):
    """Two estimates are the same, number by number."""
    np.testing.assert_equal(dataclasses.asdict(found), dataclasses.asdict(expected))


def test_the_prior_and_the_metadata_follow_the_settings(image, plate_file, estimate):
    from crfnet_core.posterior import Prior

    image.camera_response_settings.prior = "any"
    bpy.ops.crf.estimate_response(image=image.name, ignore_metadata=True)
    assert_equal(stored(image), estimate(plate_file, prior=Prior.load("any"), use_metadata=False))
    settings = image.camera_response_settings
    assert (settings.prior, settings.ignore_metadata) == ("any", True)


def test_what_took_the_plate_may_be_told(image, plate_file, estimate):
    from crfnet_core.photograph.metadata import Device

    bpy.ops.crf.estimate_response(image=image.name, device="phone")
    assert_equal(stored(image), estimate(plate_file, device=Device.PHONE))
    assert image.camera_response_settings.device == "phone"
    bpy.ops.crf.estimate_response(image=image.name, device="file")
    assert_equal(stored(image), estimate(plate_file))
