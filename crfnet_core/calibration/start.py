"""The start of the fit: the known response under which the frames agree best (Mitsunaga and Nayar's criterion)."""

from __future__ import annotations

import numpy as np

from crfnet_core.calibration.blocks import Observations
from crfnet_core.posterior import ResponseBank
from crfnet_core.response.curve import SAMPLES, ResponseCurve
from crfnet_core.types import Float64Array

#: Samples that the known responses are compared on, and the seed of their choice.
COMPARED, SEED = 400, 0

#: Largest disagreement in 8-bit codes that counts: beyond, a sample is an outlier.
LARGEST_SPREAD = 20.0

#: Stops that a code is at least worth: where it is worth less, it does not separate responses.
LEAST_STOPS = 0.004


def best_known_response(seen: Observations, exposures: Float64Array) -> ResponseCurve:
    """Return the response of the packaged bank under which samples have the same irradiance in every frame.

    The measure is the mean spread over frames of log2 g(B) less the exposure, in units of the spread that one code of
    noise makes. Source: Mitsunaga and Nayar, "Radiometric self calibration", CVPR 1999.
    """
    bank = ResponseBank.load()
    rng = np.random.default_rng(SEED)
    often = np.flatnonzero(seen.is_used.sum(axis=1) >= 2)
    some = seen.subset(rng.permutation(often)[:COMPARED])
    tables = bank.log_irradiance[bank.ordinary]
    code = np.rint(some.brightness * (SAMPLES - 1)).astype(np.intp)
    noise = np.gradient(tables, axis=1) * np.float32((SAMPLES - 1) / 255)
    disagreement = np.zeros(len(tables))
    for start in range(0, len(tables), 256):
        part = slice(start, start + 256)
        logs = tables[part][:, code] - exposures.astype(np.float32)  # (256, M, T)
        per_code = np.maximum(noise[part][:, code], LEAST_STOPS)
        weight = np.where(some.is_used, per_code**-2, 0)
        mean = (weight * logs).sum(axis=2, keepdims=True) / np.maximum(weight.sum(axis=2, keepdims=True), 1e-9)
        codes_off = np.where(some.is_used, np.minimum(np.abs(logs - mean) / per_code, LARGEST_SPREAD), 0)
        disagreement[part] = (codes_off**2).sum(axis=(1, 2))
    best = int(disagreement.argmin())
    return ResponseCurve.from_samples(bank.brightness[bank.ordinary][best])


def rough_irradiance(seen: Observations, exposures: Float64Array, curve: ResponseCurve) -> Float64Array:
    """Return log2 of each sample's irradiance under a response, shape (M,): the mean over frames, NaN if none shows it.

    Frames count by their slope df/du, so that the best exposed ones decide.
    """
    codes = np.linspace(0, 1, SAMPLES)
    table = np.log2(np.maximum(curve.inverse(codes), 2.0**-14))  # the least of `CurveModel`'s table
    slope = 1 / np.maximum(np.gradient(table, codes), 1e-3)
    index = np.rint(seen.brightness * (SAMPLES - 1)).astype(np.intp)
    weight = seen.is_used * slope[index] ** 2
    total = weight.sum(axis=1)
    mean = (weight * (table[index] - exposures)).sum(axis=1) / np.maximum(total, 1e-12)
    return np.where(total > 0, mean, np.nan)
