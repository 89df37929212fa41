import json

import pytest

from crfnet_core.errors import CRFNetError, PriorError
from crfnet_core.photograph.metadata import Device, with_stated_device
from crfnet_core.posterior import Family, Prior
from crfnet_core.posterior.factors import FACTORS, family_factors
from crfnet_core.posterior.prior import DEFAULT_PRIOR, packaged_priors
from tests.core.test_file_origin import OWN_CAMERA, origin
from tests.helpers.folders import written
from tests.helpers.refusals import refused


def prior_file(folder, entries):
    return written(folder / "own.json", entries if isinstance(entries, str) else json.dumps(entries))


def test_the_packaged_priors_are_distributions():
    assert packaged_priors() == ["any", "camera"]
    for name in packaged_priors():
        prior = Prior.load(name)
        assert prior.name == name
        assert sum(prior.shares.values()) == pytest.approx(1)
        assert set(prior.shares) == set(Family)
        assert 0 < prior.evidence <= 1
    assert Prior.load() == Prior.load(DEFAULT_PRIOR)


def test_a_file_of_ones_own_is_scaled_to_a_sum_of_1(tmp_path):
    prior = Prior.load(prior_file(tmp_path, {"shares": {"phone": 0.5, "log": 0.3}, "evidence": 1}))
    assert prior.shares == pytest.approx({Family.PHONE: 0.625, Family.LOG: 0.375})
    assert (prior.name, prior.evidence) == ("own", 1)


def test_factors_shift_the_shares():
    prior = Prior("p", {Family.PHONE: 0.6, Family.CAMERA: 0.3, Family.FILM: 0.1}, 0.5)
    shifted = prior.reweighted({Family.PHONE: 0.1, Family.FILM: 1.0})
    assert [0.46 * shifted.shares[family] for family in prior.shares] == pytest.approx([0.06, 0.3, 0.1])
    assert (shifted.name, shifted.evidence) == ("p", 0.5)
    assert prior.reweighted({}).shares == pytest.approx(prior.shares)


#: A prior of phones alone, and for each code entries of a file that are refused.
PHONE = {"shares": {"phone": 1}, "evidence": 1}
REFUSED = {
    "prior_not_json": ("{", '{"shares": {"phone": NaN}, "evidence": 1}'),
    "bad_prior": ([1], {"shares": {"phone": 1}}, PHONE | {"more": 1}),
    "bad_prior_families": (PHONE | {"shares": [0.5]}, PHONE | {"shares": {"telephone": 1}}),
    "bad_prior_values": (
        *(PHONE | {"shares": shares} for shares in ({"phone": -0.1}, {"phone": "1"}, {"phone": 0, "log": 0})),
        *(PHONE | {"evidence": 1.5}, PHONE | {"evidence": True}, PHONE | {"plain": -0.1}),
    ),
    "bad_lookalikes": (PHONE | {"lookalikes": 1},),
}


@pytest.mark.parametrize(("code", "entries"), [(code, each) for code, several in REFUSED.items() for each in several])
def test_a_file_that_describes_no_prior_is_refused_in_one_line(tmp_path, code, entries):
    path = prior_file(tmp_path, entries)
    with refused(PriorError, code, path=path):
        Prior.load(path)


def test_an_unknown_name_lists_the_known_ones():
    for name in ("nonesuch", "x" * 300):
        with refused(PriorError, "no_prior", names="any, camera"):
            Prior.load(name)
    with refused(CRFNetError, "argument_kind", name="prior"):
        Prior.load(5)


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
