import json

import pytest

from crfnet_core.errors import CRFNetError, PriorError
from crfnet_core.posterior import Family, Prior
from crfnet_core.posterior.prior import DEFAULT_PRIOR, packaged_priors
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
