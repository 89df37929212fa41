"""Measure a camera's response, from an exposure stack (`calibrate`), or from raw files and their JPEGs (`raw_pairs`).

The packages that `raw_pairs` needs are optional, so nothing here imports it by itself. docs/CALIBRATE.md has the
equations, and how good it is.
"""

from crfnet_core.calibration.calibrate import calibrate_pairs, calibrate_stack
from crfnet_core.calibration.exposures import ExposureLabel, parse_times
from crfnet_core.calibration.measured import Calibration, FrameReport, MeasuredResponse, PairCalibration, ShotReport

__all__ = ["Calibration", "ExposureLabel", "FrameReport", "MeasuredResponse", "PairCalibration", "ShotReport"]
__all__ += ["calibrate_pairs", "calibrate_stack", "parse_times"]
