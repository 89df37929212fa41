"""Reading photographs with Blender's own OpenImageIO, which is mostly older than the command's."""

from tests.core.image_io.test_odd_files import test_names_that_are_not_utf8 as test_names_that_are_not_utf8
from tests.core.test_photo import test_every_orientation_is_turned_upright as test_every_orientation_is_turned_upright

from .helpers import bpy as bpy
