"""How far a measured response may be off: its shape and its scale, both in stops (Eq. C.4 and C.5)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
    even = measurement.seen.block % 2 == 0
    parts = [_curve_of(measurement.seen.subset(part), measurement.exposures, measurement) for part in (even, ~even)]
    alone = [_channel_curve(measurement, channel) for channel in range(measurement.fit.offsets.shape[1])]
    others = [] if other_labels is None else [other_labels]
    curve, first, second = (in_file_codes(each, white) for each in (measurement.curve, *parts))

    def disagreements(error: Callable[[ResponseCurve, ResponseCurve], float]) -> dict[str, float]:
        """Return how far responses are apart that should be one."""
        return {
            "sampling": abs(error(first, second)) / 2,
            "channels": CHANNEL_PART * _rms([error(curve, in_file_codes(each, white)) for each in alone]),
            "labels": 0.5 * _rms([error(curve, in_file_codes(each, white)) for each in others]),
        }

    codes = np.minimum(np.arange(FIRST_SHAPE_CODE, LAST_SHAPE_CODE + 1) / 255 / white, 1)  # white = 1
    shape, scale = measurement.fit.deviations(codes)
    trend = TIME_DEVIATION / np.linalg.norm(measurement.exposures - measurement.exposures.mean())
    times = float(trend * np.log2(measurement.curve.inverse(codes)).std())
    return Uncertainty(
        {"posterior": shape, **disagreements(shape_error), "times": times, "least": LEAST_SHAPE},
        {"posterior": scale, **disagreements(scale_error), "white": measurement.anchor.deviation, "least": LEAST_SCALE},
    )


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


def _rms(values: Sequence[float]) -> float:
    """Return the root mean square, 0 of nothing."""
    return float(np.linalg.norm(values) / np.sqrt(max(len(values), 1)))
