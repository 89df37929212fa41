"""The irradiance at which the codes reach white, which sets the scale of a response (Eq. C.3)."""

from dataclasses import dataclass

import numpy as np

from crfnet_core.calibration.blocks import PARTLY_WHITE, Observations
from crfnet_core.calibration.solver import StackFit
from crfnet_core.types import Float64Array

#: 8-bit codes from which the crossing is extrapolated in a straight line, and through which the parabola leads.
LINE_FROM, PARABOLA_FROM, LAST_CODE, WHITE_CODE = 252, 240, 254, 254.5

#: Samples that have to be white in one frame and measured in another for the crossing to be known.
LEAST_CROSSINGS = 30

#: Fraction of the samples, the flattest, that the crossing is looked for in.
FLATTEST = 0.5

#: Stops below the crossing in which the fraction of white pixels is taken, and the fraction that noise makes there.
BELOW, NOISE_BELOW = 0.5, 0.02

#: Standard deviation in stops of the anchor where its methods agree: the end of a response is seen in steps of a code.
LEAST_DEVIATION = 0.02

#: Standard deviation in stops where no frame reaches white: the end comes from known responses.
UNSEEN_DEVIATION = 0.4


@dataclass(frozen=True)
class Anchor:
    """The irradiance at which the codes reach white."""

    log_white: float  # log2 of the irradiance of white, in the units of the fit; 0 if the fit has it right
    deviation: float  # its standard deviation in stops
    is_seen: bool  # whether samples reach white in some frame and are measured in another


def find_white(seen: Observations, exposures: Float64Array, fit: StackFit) -> Anchor:
    """Return where white is.

    Two ways: the irradiance at which half the pixels of flat samples are white, which is half a code below the end;
    and a parabola for the irradiance over the last codes of the fitted curve. The first counts twice. Where surfaces
    have texture, samples become white gradually, and both ways find white too high, by about the blur of `_crossing`.
    The deviation holds how far the two are apart, half the blur, and the last half code, which no pixel shows.
    """
    crosses = seen.is_white.any(axis=1) & seen.is_used.any(axis=1)
    if crosses.sum() < LEAST_CROSSINGS:
        return Anchor(0.0, UNSEEN_DEVIATION, is_seen=False)
    codes = np.arange(PARABOLA_FROM, LAST_CODE + 1)
    irradiance = np.exp2(fit.log_inverse(codes / 255))
    parabola = np.polyfit(codes / 255 - 1, irradiance, 2)[-1]
    parabolic = float(np.log2(max(parabola, irradiance[-1])))
    crossing, blur = _crossing(seen, fit.exposed(exposures, seen))
    before = float(fit.log_inverse(np.array([LINE_FROM / 255]))[0])
    per_code = max(np.exp2(crossing) - np.exp2(before), 0) / (WHITE_CODE - LINE_FROM)
    crossed = float(np.log2(np.exp2(crossing) + per_code * (255 - WHITE_CODE)))
    parts = (LEAST_DEVIATION, (crossed - parabolic) / 2, blur / 2, crossed - crossing)
    return Anchor((2 * crossed + parabolic) / 3 - blur, float(np.linalg.norm(parts)), is_seen=True)


def _crossing(seen: Observations, log_exposed: Float64Array) -> tuple[float, float]:
    """Return log2 of the irradiance that parts white pixels from others best, over the flattest samples; and its blur.

    The blur, in stops, is the fraction of white pixels below this irradiance, as far as it is more than noise makes.
    """
    partly = (seen.white_fraction > PARTLY_WHITE).any(axis=1)
    flat = seen.spread <= np.quantile(seen.spread[partly], FLATTEST)
    order = log_exposed[flat].ravel().argsort()
    stops, white = log_exposed[flat].ravel()[order], seen.white_fraction[flat].ravel()[order]
    near = np.abs(stops - stops[np.cumsum(white - 0.5).argmin()]) < 1
    stops, white = stops[near], white[near]
    crossing = float(stops[np.cumsum(white - 0.5).argmin()])
    below = white[(stops < crossing) & (stops > crossing - BELOW)]
    return crossing, max(float(below.mean()) - NOISE_BELOW, 0.0) if len(below) else 0.0
