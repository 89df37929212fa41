"""The empirical model of response (EMoR): a mean response and its principal components (Eq. 1 of docs/METHOD.md)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from crfnet_core.errors import CurveError
from crfnet_core.response.curve import SAMPLES, numbers_of
from crfnet_core.types import Float64Array

COMPONENTS = 11  # components of the basis, and so weights of an estimate (CRF-net paper, Sec. 3.1)

#: The packaged basis; and how far from 0 and 1 the ends of responses may lie, as the rounded ones of DoRF do.
BASIS_FILE = Path(__file__).parents[1] / "data" / "emor.npz"
SAME_ENDS = 1e-3


@dataclass(frozen=True, eq=False)
class EmorBasis:
    """A mean response and orthonormal components: f = mean + weights @ components.

    `data/emor.npz` was computed from the 201 curves of DoRF (Grossberg & Nayar) by
    ``python -m training.data.emor_basis``: the curves at 1024 uniform irradiances; their mean; the singular vectors of
    the remainder, the 11 of largest singular value, each with unit L2 norm over the 1024 samples and a positive sum. So
    a distance between two weight vectors is the estimation error between the two reconstructions.

    Source: Grossberg & Nayar, "Modeling the space of camera response functions", TPAMI 2004.

    Parameters
    ----------
    mean : ndarray, float64, shape (1024,)
        The mean response.
    components : ndarray, float64, shape (11, 1024)
        Orthonormal rows, most variance first.
    """

    mean: Float64Array
    components: Float64Array

    @classmethod
    @cache
    def load(cls) -> EmorBasis:
        """Return the packaged basis."""
        with np.load(BASIS_FILE) as arrays:
            return cls(arrays["mean"], arrays["components"])

    @classmethod
    def from_curves(cls, curves: ArrayLike) -> EmorBasis:
        """Return the basis of responses of shape (N, 1024), N > 11: how `data/emor.npz` is made."""
        samples = np.asarray(curves, dtype=np.float64)
        if samples.ndim != 2 or samples.shape[1] != SAMPLES or samples.shape[0] <= COMPONENTS:
            raise ValueError(f"a basis needs more than {COMPONENTS} curves of {SAMPLES} samples, got {samples.shape}")
        mean = samples.mean(axis=0)
        components = np.linalg.svd(samples - mean, full_matrices=False)[2][:COMPONENTS]
        return cls(mean, components * np.sign(components.sum(axis=1, keepdims=True)))

    def project(self, curves: ArrayLike) -> Float64Array:
        """Return the weights, shape (..., 11), of responses from 0 to 1, (..., 1024); raise CurveError for others."""
        rows = _rows(curves, SAMPLES)
        if np.abs(rows[..., [0, -1]] - (0, 1)).max(initial=0) > SAME_ENDS:
            raise CurveError("curve_not_strict")
        return (rows - self.mean) @ self.components.T

    def reconstruct(self, weights: ArrayLike) -> Float64Array:
        """Return the responses, shape (..., 1024), of weights of shape (..., 11).

        The response of arbitrary weights need not be monotone: see `ResponseCurve.from_samples`. Raises as `project`.
        """
        return self.mean + _rows(weights, COMPONENTS) @ self.components


def _rows(values: ArrayLike, length: int) -> Float64Array:
    """Return finite numbers, shape (..., length), in double precision."""
    rows = np.asarray(numbers_of(values, CurveError), dtype=np.float64)
    if rows.shape[-1:] != (length,) or not np.isfinite(rows).all():
        raise CurveError("curve_rows", length=length, shape=rows.shape)
    return rows
