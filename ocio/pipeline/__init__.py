"""The one way from photographs to files, for the command and for the add-on. Nothing here prints or draws a bar.

estimates  photographs or frames -> the response estimated from them -> its LUT and its exposure
folders    the folder that `crfnet estimate` writes: all checks first, then LUTs, plates, sheets, documents and config
delivery   what is made of a LUT alone: the linear frames of a sequence, or LUT files and a config

Every step raises a `crfnet_core.CRFNetError` for what the user can mend. A progress callback takes (done, total); what
it raises ends the step, after the step has removed its unfinished files. A config in which Blender or another program
finds the plate's colour space at its start is the job of `ocio.configs.installed`.
"""

from ocio.pipeline.delivery import bake_plates, export_luts
from ocio.pipeline.estimates import (
    PhotographEstimate,
    anchored_exposure,
    estimate_frames,
    estimate_photographs,
    load_network,
    response_lut,
)
from ocio.pipeline.folders import OutputPlan, plan_outputs, write_estimates

__all__ = [
    "OutputPlan",
    "PhotographEstimate",
    "anchored_exposure",
    "bake_plates",
    "estimate_frames",
    "estimate_photographs",
    "export_luts",
    "load_network",
    "plan_outputs",
    "response_lut",
    "write_estimates",
]
