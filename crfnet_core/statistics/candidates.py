"""Candidate responses: a grid over the first two EMoR weights, as tables over the 256 codes.

The equations between channels (`channel_equations`) hold to first order only. The exact question, whether the mixing
ratios agree between the channels, can only be asked of a given response. So it is asked of 32, and the network reads
how well each of them does.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from crfnet_core.response.curve import UNIFORM, ResponseCurve
from crfnet_core.response.emor import COMPONENTS, EmorBasis
from crfnet_core.statistics.sampling import CODES
from crfnet_core.types import Float32Array

#: The grid of the first two EMoR weights: it spans 81 % of the responses of DoRF, and 97 % of those measured on real
#: bodies.
FIRST_WEIGHTS = (-9.0, -5.0, -2.5, -0.5, 1.0, 2.5, 4.0, 6.0)
SECOND_WEIGHTS = (-1.8, -0.6, 0.6, 2.0)

CANDIDATE_COUNT = len(FIRST_WEIGHTS) * len(SECOND_WEIGHTS)

IDENTITY_FRACTION = 0.02  # of the identity, mixed into every candidate so that no inverse is too steep for 8 bits


@dataclass(frozen=True)
class CandidateResponses:
    """The candidates' inverse responses at every code, each array float32 (256, CANDIDATE_COUNT)."""

    irradiance: Float32Array  # g
    slope: Float32Array  # g', per code
    log_slope: Float32Array  # natural logarithms, as the next; the irradiance of code 0 counts as code 1's
    log_irradiance: Float32Array
    #: The variance of a difference of two logarithms of irradiances around a code that rounding to codes makes.
    log_variance: Float32Array


@cache
def candidate_responses() -> CandidateResponses:
    """Return the candidates, made from the EMoR basis once."""
    weights = np.zeros((CANDIDATE_COUNT, COMPONENTS))
    weights[:, :2] = [(first, second) for first in FIRST_WEIGHTS for second in SECOND_WEIGHTS]
    curves = [ResponseCurve.from_samples(samples) for samples in EmorBasis.load().reconstruct(weights)]
    mixed = [(1 - IDENTITY_FRACTION) * curve.brightness + IDENTITY_FRACTION * UNIFORM for curve in curves]
    irradiance = np.stack([np.interp(np.linspace(0, 1, CODES), curve, UNIFORM) for curve in mixed], axis=1)
    slope = np.gradient(irradiance, axis=0)
    positive = np.maximum(irradiance, irradiance[1])
    log_variance = (slope / positive) ** 2 / 6  # two roundings of variance 1 / 12
    tables = (irradiance, slope, np.log(slope), np.log(positive), log_variance)
    return CandidateResponses(*(table.astype(np.float32) for table in tables))
