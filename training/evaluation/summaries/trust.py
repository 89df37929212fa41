"""P4: how often a model says that an answer can be used when it is far off."""

from __future__ import annotations

from collections.abc import Sequence

from crfnet_core.posterior import Verdict
from training.evaluation.measure.figures import PhotographFigures
from training.evaluation.report.real.content import FAR_OFF, FAR_OFF_STOPS, TrustedWrongly


def trusted_wrongly(figures: Sequence[PhotographFigures]) -> TrustedWrongly:
    """Return how many photographs have the verdict "good" or "usable", and how many of these are far off."""
    errors = [
        (row.estimation > FAR_OFF, row.shape > FAR_OFF_STOPS)
        for row in figures
        if row.verdict in (Verdict.GOOD, Verdict.USABLE)
    ]
    return TrustedWrongly(
        photographs=len(errors),
        estimation=sum(estimation for estimation, _ in errors),
        shape=sum(shape for _, shape in errors),
        either=sum(estimation or shape for estimation, shape in errors),
    )
