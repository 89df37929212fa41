"""Estimates of users who say what took a photograph."""

import pytest

from crfnet_core.photograph.metadata import Device
from crfnet_core.posterior import Family


@pytest.mark.parametrize("use_metadata", [True, False])
def test_the_device_may_be_told(estimate, plate, use_metadata):
    told, untold = estimate(plate, device=Device.PHONE, use_metadata=use_metadata), estimate(plate)
    (origin,) = told.origins
    assert (origin.device, origin.is_told) == (Device.PHONE, True)
    assert (origin.picture_shape == "16:9") is use_metadata
    assert told.families[Family.PHONE] > 1.2 * untold.families[Family.PHONE]
    assert told.families[Family.CAMERA] < 0.2 * untold.families[Family.CAMERA]


def test_a_camera_of_another_kind_is_one_all_the_same(estimate, plate):
    told, untold = (estimate(plate, **options).families for options in ({"device": Device.UNKNOWN}, {}))
    phones, cameras = (told[family] / untold[family] for family in (Family.PHONE, Family.CAMERA))
    assert phones == pytest.approx(cameras)
    assert phones > 1
