"""Measured responses of cameras, one JSON file each, to be used in the place of an estimate."""

from crfnet_core.library.answer import camera_estimate, offered_cameras, with_camera
from crfnet_core.library.camera import Camera, CameraSettings, camera_document, read_calibration
from crfnet_core.library.library import DATA_VARIABLE, CameraLibrary, find_camera, listed_cameras

__all__ = ["DATA_VARIABLE", "Camera", "CameraLibrary", "CameraSettings", "camera_document", "camera_estimate"]
__all__ += ["find_camera", "listed_cameras", "offered_cameras", "read_calibration", "with_camera"]
