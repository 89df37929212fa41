"""How far a measured response may be off: its shape and its scale, both in stops (Eq. C.4 and C.5)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from crfnet_core.calibration.blocks import Observations
from crfnet_core.calibration.curve_model import in_file_codes
from crfnet_core.calibration.measured import Uncertainty
from crfnet_core.calibration.measurement import Measurement, fit_and_anchor
from crfnet_core.calibration.solver import TIME_DEVIATION
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import FIRST_SHAPE_CODE, LAST_SHAPE_CODE, scale_error, shape_error
from crfnet_core.types import Float64Array

#: The rest in stops where nothing disagrees: blocks are not flat, JPEG, the model.
LEAST_SHAPE, LEAST_SCALE = 0.01, 0.02

#: Part of the difference between the channels' own responses that counts: they have a response in common.
CHANNEL_PART = 0.5

#: Least samples of a channel for a response of its own.
LEAST_SAMPLES = 60


def uncertainty_of(measurement: Measurement, other_labels: ResponseCurve | None, *, white: float) -> Uncertainty:
    """Return how far a measured response may be off, at the codes of the file.

    `white` is the code of white as a part of the largest. `other_labels` is the response by the other reading of the
    exposure labels, if there is one.
    """
    curve = in_file_codes(measurement.curve, white)
    even = measurement.seen.block % 2 == 0
    parts = [_curve_of(measurement.seen.subset(part), measurement.exposures, measurement) for part in (even, ~even)]
    first, second = (in_file_codes(part, white) for part in parts)
    alone = (_channel_curve(measurement, channel) for channel in range(measurement.fit.offsets.shape[1]))
    channels = [in_file_codes(channel, white) for channel in alone]
    others = [] if other_labels is None else [in_file_codes(other_labels, white)]
    codes = np.minimum(np.arange(FIRST_SHAPE_CODE, LAST_SHAPE_CODE + 1) / 255 / white, 1)  # white = 1
    posterior = measurement.fit.deviations(codes)
    shape = {
        "posterior": posterior[0],
        "sampling": shape_error(first, second) / 2,
        "channels": CHANNEL_PART * _rms(shape_error(curve, channel) for channel in channels),
        "times": _time_deviation(measurement, codes),
        "labels": 0.5 * _rms(shape_error(curve, other) for other in others),
        "least": LEAST_SHAPE,
    }
    scale = {
        "posterior": posterior[1],
        "sampling": abs(scale_error(first, second)) / 2,
        "channels": CHANNEL_PART * _rms(scale_error(curve, channel) for channel in channels),
        "white": measurement.anchor.deviation,
        "labels": 0.5 * _rms(scale_error(curve, other) for other in others),
        "least": LEAST_SCALE,
    }
    return Uncertainty(shape, scale)


def _curve_of(seen: Observations, exposures: Float64Array, measurement: Measurement) -> ResponseCurve:
    """Return the response of a part of the samples, or of all if the part is too small."""
    if len(seen.block) < LEAST_SAMPLES:
        return measurement.curve
    return fit_and_anchor(seen, exposures, measurement.fit.weights, rounds=1).curve


def _channel_curve(measurement: Measurement, channel: int) -> ResponseCurve:
    """Return the response of one channel by itself, with the exposures that all channels found for it."""
    part = measurement.seen.subset(measurement.seen.channel == channel)
    alone = replace(part, channel=np.zeros_like(part.channel))
    return _curve_of(alone, measurement.exposures + measurement.fit.offsets[:, channel], measurement)


def _time_deviation(measurement: Measurement, codes: Float64Array) -> float:
    """Return the shape error in stops at some codes if labels are off by `TIME_DEVIATION` each: a trend bends it."""
    trend = TIME_DEVIATION / np.sqrt(((measurement.exposures - measurement.exposures.mean()) ** 2).sum())
    return float(trend * np.log2(measurement.curve.inverse(codes)).std())


def _rms(values: Iterable[float]) -> float:
    """Return the root mean square, 0 of nothing."""
    squares = [value**2 for value in values]
    return float(np.sqrt(np.mean(squares))) if squares else 0.0
