"""Log footage by its levels: how much more likely they make it, and which published curve lies nearest."""

from dataclasses import dataclass

import numpy as np

from crfnet_core.photograph.recognition.levels import Levels, quantile
from crfnet_core.response.log_curves import LOG_CURVES, LogCurve, reflectance_of

#: Log curves put black at 0.088 and above; noise goes a little below. Of 92 real photographs one has no sample below
#: this brightness, so 2 of 94 may (rule of succession), and all log footage that is stored as its maker specifies.
LIFTED_BLACK, BLACK_FACTOR = 0.078, 94 / 2

#: Highest black, and smallest distance from it to white, of log footage: all of 180 simulated frames have a lower and a
#: larger one. Haze and sky lie higher; a wall or a gray card spans less.
HIGHEST_BLACK, LEAST_SPAN = 0.28, 0.4

#: A sensor is full before its log curve ends: 89 % of simulated log footage has its white below this brightness, and
#: 20 % of 92 real photographs.
LOW_WHITE, LOW_WHITE_FACTOR, HIGH_WHITE_FACTOR = 0.97, 0.89 / 0.2, 0.11 / 0.8

#: The reflectances at which the median and the darkest samples of an exposed scene are expected, and the standard
#: deviations of either in stops.
MIDDLE_REFLECTANCE, MIDDLE_STOPS = 0.17, 1.1
DARKEST_REFLECTANCE, DARKEST_STOPS = 0.003, 1.4

#: How far below a curve's black noise may take the darkest samples, and the deviation of samples lower yet.
NOISE, NOISE_DEVIATION = 0.004, 0.003

#: Curves that are named; the fraction of the samples below the codes over which the light of two curves is compared.
MOST_NAMED, DARK = 4, 0.01


@dataclass(frozen=True)
class NearCurve:
    """A published curve that the levels of log footage may have."""

    name: str  # as in `LOG_CURVES`
    probability: float  # by the levels alone
    expected_error: float  # of its light, in stops, over all curves that it may be: see `light_error`


def log_factor(levels: Levels) -> float:
    """Return the likelihood ratio of the levels under log footage and ordinary photographs: Eq. L.3; 1 if undecided."""
    is_lifted = LIFTED_BLACK <= levels.black <= HIGHEST_BLACK
    if not is_lifted or levels.white - levels.black < LEAST_SPAN:
        return 1.0
    return BLACK_FACTOR * (LOW_WHITE_FACTOR if levels.white < LOW_WHITE else HIGH_WHITE_FACTOR)


def nearest_curves(levels: Levels, makes: tuple[str, ...] = ()) -> tuple[NearCurve, ...]:
    """Return up to four published curves, of `makes` if known, that explain black and the middle best: Eq. L.4."""
    makers = " ".join(makes).casefold()
    tried = {name: curve for name, curve in LOG_CURVES.items() if name.split()[0].casefold() in makers} or LOG_CURVES
    names, curves = list(tried), list(tried.values())
    scores = np.array([_log_likelihood(curve, levels) for curve in curves])
    weights = np.exp(scores - scores.max())
    probabilities = weights / weights.sum()
    near = []
    for number in np.argsort(-scores)[:MOST_NAMED]:
        errors = [light_error(curves[number], true, levels) for true in curves]
        near.append(NearCurve(names[number], float(probabilities[number]), float(probabilities @ errors)))
    return tuple(near)


def light_error(named: LogCurve, true: LogCurve, levels: Levels) -> float:
    """Return how far the light of a picture is off, in stops, if one curve is taken for another: a shape error."""
    codes = np.linspace(quantile(levels.histogram, DARK), levels.white, 64)
    return float(np.log2(reflectance_of(named, codes) / reflectance_of(true, codes)).std())


def _log_likelihood(curve: LogCurve, levels: Levels) -> float:
    """Return the log likelihood of black and the middle under a curve, up to a constant."""
    black = float(curve(0.0))
    levels_seen = np.array([levels.middle, max(levels.black, black + NOISE)])
    below = max(0.0, black - NOISE - levels.black) / NOISE_DEVIATION
    expected = MIDDLE_REFLECTANCE, DARKEST_REFLECTANCE
    stops = np.log2(reflectance_of(curve, levels_seen) / expected) / (MIDDLE_STOPS, DARKEST_STOPS)
    return float(-below - (stops**2).sum() / 2)
