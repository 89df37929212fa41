"""Responses of one's cameras: measured, or estimated from photographs whose evidence accumulates.

- `camera`: a camera, and what is kept of its photographs.
- `documents`: the same as JSON, and the measured response in the document of `crfnet calibrate`.
- `library`: the cameras in a folder: the user's own, and measured ones that come with this project.
- `additions`: photographs or a measured response for a camera.
- `answer`: a camera's response as an estimate, and photographs against it.
- `matching`: the cameras that a photograph's metadata fit.
"""

from crfnet_core.library.additions import Addition, add_measured, add_photographs, remove_photographs
from crfnet_core.library.answer import camera_estimate, compared, differences, with_camera
from crfnet_core.library.camera import Camera, CameraSettings, KeptPhotograph, MeasuredResponse
from crfnet_core.library.documents import camera_document, read_calibration
from crfnet_core.library.library import DATA_VARIABLE, CameraLibrary, find_camera
from crfnet_core.library.matching import listed_cameras, matching_cameras, offered_cameras

__all__ = [
    "DATA_VARIABLE",
    "Addition",
    "Camera",
    "CameraLibrary",
    "CameraSettings",
    "KeptPhotograph",
    "MeasuredResponse",
    "add_measured",
    "add_photographs",
    "camera_document",
    "camera_estimate",
    "compared",
    "differences",
    "find_camera",
    "listed_cameras",
    "matching_cameras",
    "offered_cameras",
    "read_calibration",
    "remove_photographs",
    "with_camera",
]
