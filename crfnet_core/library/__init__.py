"""Measured responses of cameras, one JSON file each, to be used in the place of an estimate.

- `camera`: a camera, and the rule for its name.
- `documents`: the same as JSON, and the document of a calibration as a camera.
- `library`: the cameras in a folder: the user's own, and those that come with this project.
- `answer`: a camera's response as an estimate, and the cameras of a photograph's make and model.
"""

from crfnet_core.library.answer import camera_estimate, offered_cameras, with_camera
from crfnet_core.library.camera import Camera, CameraSettings
from crfnet_core.library.documents import camera_document, read_calibration
from crfnet_core.library.library import DATA_VARIABLE, CameraLibrary, find_camera, listed_cameras

__all__ = ["DATA_VARIABLE", "Camera", "CameraLibrary", "CameraSettings", "camera_document", "camera_estimate"]
__all__ += ["find_camera", "listed_cameras", "offered_cameras", "read_calibration", "with_camera"]
