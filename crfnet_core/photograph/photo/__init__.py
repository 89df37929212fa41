"""A photograph: the code values that the camera or the developer wrote, before any colour management.

photo     `Photo`, which is analysed, and `CodeValues`, the integer samples of a file
arrays    pixels from the arrays of NumPy, Pillow and OpenCV
"""

from crfnet_core.photograph.photo.arrays import ColorOrder
from crfnet_core.photograph.photo.photo import CodeArray, CodeValues, Photo

__all__ = ["CodeArray", "CodeValues", "ColorOrder", "Photo"]
