"""Estimates and files in words, as documents and as pictures.

facts        photographs and errors in words, and the provenance that LUT files carry
words        lines for people: of the command and of the add-on
documents    the same for machines, ready for JSON
calibration  a measured response in words, as JSON and as provenance
sheet        the picture of an estimate; calibration_sheet of a measured response: both need matplotlib
"""

from .calibration import Measured, calibration_document, calibration_lines, calibration_provenance, comparison_lines
from .documents import camera_summary, estimate_document, lut_document, plate_document
from .facts import PhotoFacts, Phrases, provenance
from .words import (
    camera_line,
    file_lines,
    light_lines,
    lut_lines,
    offer_lines,
    plate_lines,
    result_line,
    source_line,
    verdict_advice,
    verdict_lines,
)

__all__ = ["Measured", "PhotoFacts", "Phrases", "calibration_document", "calibration_lines", "calibration_provenance"]
__all__ += ["camera_line", "camera_summary", "comparison_lines", "estimate_document", "file_lines", "light_lines"]
__all__ += ["lut_document", "lut_lines", "offer_lines", "plate_document", "plate_lines", "provenance", "result_line"]
__all__ += ["source_line", "verdict_advice", "verdict_lines"]
