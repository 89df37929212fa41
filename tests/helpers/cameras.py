"""Cameras with known responses, and photographs with EXIF."""

from crfnet_core import ResponseCurve
from crfnet_core.library import Camera, CameraSettings
from tests.helpers.images import read_image, write_image


def camera(name, gamma=2.2, *, stops=0.1, **settings):
    """Return a camera whose response is a power law, measured on six exposures."""
    return Camera(name, ResponseCurve.gamma(gamma), 0.05, stops, "6 exposures", CameraSettings(**settings))


def photograph(plate, path, **header):
    """Write the bundled photograph with the EXIF of a camera, and return its path."""
    return write_image(path, read_image(plate), **({"Make": "SONY", "Model": "ILCE-7M3"} | header))
