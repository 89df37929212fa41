"""The one way from photographs to files, for the command and for the add-on.

estimates  photographs or frames to the response estimated from them, and its LUT
loading    the network, the prior and the stored camera that the options name
folders    the folder that `crfnet estimate` writes: all checks first, then LUTs, plates, sheet, document and config
each       many photographs, one response each, with its files
each_linear  many photographs as linear EXR
batch      what both have in common: recorded as they end, continued when interrupted
photographs  which photographs these are
manifest   the file of these records
workers    processes of this machine, or a Dask cluster
calibrations  the folder that `crfnet calibrate` writes, and responses to compare with
delivery   what is made of one LUT: the linear frames of a sequence, or LUT files and a config

Nothing here prints. Every step raises a `crfnet_core.CRFNetError` for what the user can mend. A progress callback is
called with (done, total); whatever it raises ends the step, which first removes its unfinished files. For a
config that is built on another one, see `crfnet.configs.derived`.
"""

from ..luts.exposure import anchored_exposure
from .calibrations import CalibrationPlan, plan_calibration, response_to_compare, write_calibration
from .delivery import all_or_none
from .each import estimate_each, plan_each
from .each_linear import linearize_each, plan_each_linear
from .estimates import (
    PhotographEstimate,
    estimate_frames,
    estimate_photographs,
    response_lut,
    sampled_photographs,
)
from .folders import OutputPlan, plan_outputs, write_outputs
from .loading import load_camera_response, load_network, load_prior
from .manifest import PhotographRecord, check_records
from .photographs import find_photographs

__all__ = [
    "CalibrationPlan",
    "OutputPlan",
    "PhotographEstimate",
    "PhotographRecord",
    "all_or_none",
    "anchored_exposure",
    "check_records",
    "estimate_each",
    "estimate_frames",
    "estimate_photographs",
    "find_photographs",
    "linearize_each",
    "load_camera_response",
    "load_network",
    "load_prior",
    "plan_calibration",
    "plan_each",
    "plan_each_linear",
    "plan_outputs",
    "response_lut",
    "response_to_compare",
    "sampled_photographs",
    "write_calibration",
    "write_outputs",
]
