"""Pool the evidence of windows as the CRF-net paper does: remove outliers, then take the mean.

Only a network without learned pooling is pooled this way. `agreeing` runs for every network, because the report counts
the windows that agree.
"""

from collections.abc import Sequence

import numpy as np

from crfnet_core.posterior import Evidence
from crfnet_core.types import BoolArray

#: A window is an outlier when its estimate lies farther than this many median distances from the median estimate.
OUTLIER_FACTOR = 2.0


def agreeing(windows: Sequence[Evidence]) -> BoolArray:
    """Return which windows of a photograph agree with the others, shape (N,): Eq. 20 of docs/METHOD.md.

    The distance of a location from the component-wise median is an E_est between two responses, since the basis is
    orthonormal. Windows up to `OUTLIER_FACTOR` times the median distance agree: always at least half of them.
    """
    locations = np.stack([evidence.location for evidence in windows])
    distances = np.linalg.norm(locations - np.median(locations, axis=0), axis=1)
    return np.asarray(distances <= OUTLIER_FACTOR * np.median(distances))


def robust_mean(windows: Sequence[Evidence]) -> Evidence:
    """Return the mean of the evidence of the windows that agree.

    Such a network states the factor of a whole photograph already: it was fitted to errors of these means.
    """
    inside = [evidence for evidence, agrees in zip(windows, agreeing(windows), strict=True) if agrees]
    parts = zip(*((evidence.location, evidence.factor, evidence.log_odds) for evidence in inside), strict=True)
    return Evidence(*(np.mean(part, axis=0) for part in parts))
