"""A camera that is not there, in the words of the interface."""

from blender_addon.work.wording import problem_line
from crfnet_core.errors import CameraError


def test_an_unknown_camera_has_a_remedy_in_blender(tmp_path):
    line = problem_line(CameraError("no_camera", name="nobody", folder=tmp_path))
    assert line.endswith("; choose another Camera under Advanced, or none")
