"""The add-on does without the packages that its zips may lack: enabling it, and all of a job."""

import importlib.util
import subprocess
import sys

import pytest

from tests.addon.test_rooms import BLOCKED

pytestmark = pytest.mark.skipif(importlib.util.find_spec("bpy") is None, reason="needs Blender's bpy module")

JOB = """
import sys
import bpy
import addon_utils
bpy.utils.expose_bundled_modules()
model, sequence, folder = sys.argv[1:]
assert addon_utils.enable("blender_addon", default_set=True)
bpy.context.preferences.addons["blender_addon"].preferences.model = model
image = bpy.data.images.load(sequence)
image.source = "SEQUENCE"
for apply in ("NODES", "EXPORT", "BAKE"):
    choices = {"folder": folder} if apply != "NODES" else {}
    assert bpy.ops.crf.estimate_response(image=image.name, apply=apply, anyway=True, **choices) == {"FINISHED"}
addon_utils.disable("blender_addon", default_set=True)
"""


def test_every_way_to_apply_a_sequences_response_works_without_them(root, fixed_model, tmp_path, codes):
    from tests.helpers.images import write_image

    for number in (1, 2):
        path = write_image(tmp_path / f"shot.{number:04d}.png", codes)
    command = [sys.executable, "-c", BLOCKED + JOB, str(fixed_model), str(path), str(tmp_path / "out")]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=80, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"shot.cube", "config.ocio", "shot_linear.0001.exr", "shot_linear.0002.exr"} <= names
