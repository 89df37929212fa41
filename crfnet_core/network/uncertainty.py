"""How far to trust an estimate: from the error that the network expects to an uncertainty, a band and a verdict."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from crfnet_core.response import SAMPLES, ResponseCurve
from crfnet_core.types import Float64Array

#: Uncertainties in E_est below which an estimate is good, and usable.
GOOD, USABLE = 1.0, 2.0


class Verdict(StrEnum):
    """The uncertainty in words, from the best to the worst."""

    GOOD = "good"
    USABLE = "usable"
    DO_NOT_TRUST = "do not trust"

    @classmethod
    def of(cls, uncertainty: float) -> Verdict:
        """Return the verdict on an estimate whose expected E_est is `uncertainty`."""
        if uncertainty < GOOD:
            return cls.GOOD
        return cls.USABLE if uncertainty < USABLE else cls.DO_NOT_TRUST


@dataclass(frozen=True)
class UncertaintyModel:
    """The linear model of the estimation error; fitted by training on validation photographs.

    Parameters
    ----------
    base, of_predicted, of_spread : float
        The uncertainty, in units of E_est, is base + of_predicted * (the error that the network expects of the whole,
        or without learned pooling the mean over the kept windows) + of_spread * (RMS distance of the kept windows'
        predictions from their mean).
    band_profile : tuple of float
        The shape of the 90 % band: its half-width per unit of uncertainty at uniform irradiances from 0 to 1.
    """

    base: float
    of_predicted: float
    of_spread: float
    band_profile: tuple[float, ...]

    def uncertainty(self, expected_error: float, spread: float) -> float:
        """Return the uncertainty in units of E_est: Eq. 22 of docs/METHOD.md."""
        return self.base + self.of_predicted * expected_error + self.of_spread * spread

    def band(self, curve: ResponseCurve, uncertainty: float) -> Float64Array:
        """Return the lower and upper end, shape (2, 1024), of the 90 % band around a response: Eq. 23."""
        profile = np.array(self.band_profile)
        half = uncertainty * np.interp(np.linspace(0, 1, SAMPLES), np.linspace(0, 1, len(profile)), profile)
        band: Float64Array = np.clip(np.stack([curve.brightness - half, curve.brightness + half]), 0, 1)
        return band
