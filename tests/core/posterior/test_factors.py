import pytest

from crfnet_core.photograph.metadata import Device, with_stated_device
from crfnet_core.posterior import Family
from crfnet_core.posterior.factors import FACTORS, family_factors
from tests.core.test_file_origin import OWN_CAMERA, origin


def largest(**fields):
    factors = family_factors(origin(**fields))
    return max(factors, key=factors.__getitem__)


def test_the_device_favors_its_family():
    assert largest(make="Apple", model="iPhone 6") == "phone"
    assert largest(make="Canon", model="Canon PowerShot G7") == "compact"
    assert largest(make="Canon", model="Canon EOS 20D") == "camera"
    assert largest(make="NORITSU KOKI", model="QSS-32_33") == "film"


def test_what_was_developed_is_no_rendering_of_the_camera():
    assert largest(**OWN_CAMERA, software="darktable 3.4") == "developed"
    assert largest(**OWN_CAMERA, software="GIMP 2.8") == "developed"  # other programs save what was developed
    assert family_factors(origin(**OWN_CAMERA, software="darktable 3.4"))["camera"] < 0.02


def test_the_shape_counts_only_where_no_device_is_known():
    camera = {"make": "Canon", "model": "Canon EOS 20D"}
    wide, long = {"width": 3504, "height": 1971}, {"width": 3504, "height": 2336}
    assert family_factors(origin(**camera, **wide)) == family_factors(origin(**camera, **long))
    unknown_wide, unknown_long = family_factors(origin(**wide)), family_factors(origin(**long))
    assert unknown_wide["phone"] > unknown_wide["camera"]
    assert unknown_long["camera"] > unknown_long["phone"]


@pytest.mark.parametrize("device", [Device.PHONE, Device.COMPACT, Device.CAMERA, Device.UNKNOWN])
def test_a_stated_device_is_neutral_about_log_and_linear_pictures(device):
    """They are taken with cameras, too; of screenshots and renderings nobody says so."""
    stated = dict(zip(Family, FACTORS[f"stated {device or 'other'}"], strict=True))
    own = [Family.PHONE, Family.COMPACT, Family.CAMERA] if device is Device.UNKNOWN else [Family(device)]
    assert {stated[family] for family in (*own, Family.LINEAR, Family.LOG, Family.EDITED)} == {1}
    assert stated[Family.UNEXPLAINED] < 1


def test_a_stated_device_overrules_the_file():
    assert largest(**OWN_CAMERA) == "camera"
    factors = family_factors(with_stated_device(origin(**OWN_CAMERA), Device.PHONE))
    assert factors["phone"] > 10 * factors["camera"]
