"""Curves of log footage, of `crfnet_core.photograph.recognition`: one definition for training and recognition.

Training draws from the ten that the packaged models have seen; more would change what a seed draws.
"""

from __future__ import annotations

from crfnet_core.photograph.recognition import LOG_CURVES, LogCurve

#: The curves of the packaged models' training.
TRAINING_CURVES = (
    "ARRI LogC3",
    "Apple Log",
    "Canon Log 3",
    "DJI D-Log",
    "Fujifilm F-Log",
    "Fujifilm F-Log2",
    "Nikon N-Log",
    "Panasonic V-Log",
    "RED Log3G10",
    "Sony S-Log3",
)


def log_curves() -> dict[str, LogCurve]:
    """Return name -> curve, from reflectance (any shape) to code values in about [0.09, 1], not clipped."""
    return {name: LOG_CURVES[name] for name in TRAINING_CURVES}
