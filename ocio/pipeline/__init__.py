"""The one way from photographs to files, for the command and for the add-on.

estimates    photographs, frames and movies to the response estimated from them; what this needs of the options
delivery     the files of one estimate: checked before any work is done, and written together
batch        many photographs: what they have in common, and the files of each
each         the two kinds of batches: estimates with their files, and linear EXR
run          the work of a batch: recorded as it ends, continued when interrupted
records      the file of these records
photographs  the photographs of a batch
workers      processes of this machine, or a Dask cluster
calibrations the folder that `crfnet calibrate` writes, and responses to compare with

Nothing here prints. Every step raises a `crfnet_core.CRFNetError` for what the user can mend. A progress callback is
called with (done, total); whatever it raises ends the step, which first removes its unfinished files.
"""

from ..movies.source import sequence_of
from ..plates.light import anchored_exposure
from .calibrations import is_pairs, plan_calibration, response_to_compare, write_calibration
from .delivery import OutputPlan, deliver, deliver_estimate, estimated_light, plan_outputs
from .each import EstimateBatch, LinearBatch
from .estimates import FileEstimate, estimate_files, load_camera_response, photograph_sources, response_lut
from .photographs import find_photographs
from .records import PhotographRecord
from .run import run_batch

__all__ = ["EstimateBatch", "FileEstimate", "LinearBatch", "OutputPlan", "PhotographRecord", "anchored_exposure"]
__all__ += ["deliver", "deliver_estimate", "estimate_files", "estimated_light", "find_photographs", "is_pairs"]
__all__ += ["load_camera_response", "photograph_sources", "plan_calibration", "plan_outputs", "response_lut"]
__all__ += ["response_to_compare", "run_batch", "sequence_of", "write_calibration"]
