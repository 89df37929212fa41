import numpy as np

from crfnet import defaults
from crfnet.plates.exr import SAMPLE_TYPES
from crfnet.report import words
from crfnet_core.photograph.metadata import Device
from crfnet_core.posterior import UNUSUAL, Family, Verdict, verdict
from crfnet_core.posterior.prior import DEFAULT_PRIOR, packaged_priors


def test_the_largest_exposure_of_white_fits_into_half_floats():
    assert np.finfo(np.float16).max > 2**defaults.MAX_EXPOSURE


def test_every_depth_has_a_sample_type():
    assert set(defaults.DEPTHS) == set(SAMPLE_TYPES)


def test_every_verdict_has_words():
    assert set(words.VERDICTS) == set(Verdict)
    assert set(words.REMEDIES) == set(UNUSUAL)


def test_the_priors_are_the_packaged_ones():
    assert defaults.PRIORS[0] == DEFAULT_PRIOR
    assert sorted(defaults.PRIORS) == packaged_priors()


def test_the_devices_are_those_with_a_family_of_their_own():
    assert set(defaults.DEVICES) == (set(Device) & set(Family)) | {"other"}


def test_the_reference_states_the_limit_of_the_verdict(root):
    usage = (root / "docs" / "REFERENCE.md").read_text(encoding="utf-8")
    assert f"| usable | the expected shape error is at most {verdict.USABLE_STOPS:.2f} stop" in usage
