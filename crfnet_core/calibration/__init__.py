"""Measure a camera's response, from an exposure stack or from raw files and their JPEGs.

An exposure stack of one static scene:
calibrate     the whole of it on one screen: frames in, response and two uncertainties out
exposures     exposures in stops, from EXIF or given times, as labeled and as cameras really expose
frames        the frames of a stack: read, thinned out, checked against each other, aligned
alignment     integer shifts by phase correlation of rank images
blocks        blocks of pixels, and the most informative of them
curve_model   the responses to choose from: EMoR plus splines
robust        the robust least squares that stacks and raw pairs share
solver        response, exposures and irradiances of a stack
measurement   start, fit, and the irradiance of white, without what does not fit; how far shape and scale may be off
checks        reasons to refuse a stack, and doubts

measured      the results of both
raw_pairs     a response from raw files and their JPEGs; its packages are optional, so nothing here imports it by itself

docs/CALIBRATE.md has the equations, and how good it is.
"""

from crfnet_core.calibration.calibrate import Calibration, FrameReport, calibrate_pairs, calibrate_stack
from crfnet_core.calibration.exposures import ExposureLabel, parse_times
from crfnet_core.calibration.measured import Comparison, MeasuredResponse, PairCalibration, ShotReport, Uncertainty

__all__ = ["Calibration", "Comparison", "ExposureLabel", "FrameReport", "MeasuredResponse", "PairCalibration"]
__all__ += ["ShotReport", "Uncertainty", "calibrate_pairs", "calibrate_stack", "parse_times"]
