"""Evidence, and a small bank of responses, whose posteriors can be worked out by hand."""

import numpy as np

from crfnet_core.posterior import Evidence, Family, Prior, ResponseBank
from crfnet_core.response.curve import UNIFORM

#: Exponents of the responses of `small_bank`: a response is a power of irradiance.
SMALL_BANK = {
    Family.PHONE: (0.35, 0.4),
    Family.CAMERA: (0.45, 0.5, 0.55),
    Family.FILM: (0.6, 0.75),
    Family.LINEAR: (0.95, 1.05),
    Family.LOG: (0.2,),
}


def small_bank():
    """Return a bank of ten powers of irradiance, in five families."""
    powers = [power for family in SMALL_BANK.values() for power in family]
    families = tuple(family for family, members in SMALL_BANK.items() for _ in members)
    return ResponseBank(np.stack([UNIFORM**power for power in powers]).astype(np.float32), families)


def even_prior(*, evidence=1.0, unexplained=0.0):
    """Return a prior with the same share for each family of `small_bank`."""
    share = (1 - unexplained) / len(SMALL_BANK)
    return Prior("even", dict.fromkeys(SMALL_BANK, share) | {Family.UNEXPLAINED: unexplained}, evidence)


def evidence_for(weights, *, precision=3.0, log_odds=(-50.0, -50.0, -50.0)):
    """Return evidence for the first EMoR weights of a response, of one standard deviation for all of them."""
    return Evidence(np.asarray(weights, np.float64)[:5], precision * np.eye(5), np.array(log_odds))
