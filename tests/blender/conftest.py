"""One Blender for all tests of the add-on: it starts here, before anything else loads OpenImageIO or OpenColorIO."""

import contextlib
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from tests.helpers.images import read_image

#: The user's folders, for this process and those that it starts.
USER = Path(tempfile.mkdtemp(prefix="crf_blender_user_"))

ANEW = """
import sys
import bpy
import addon_utils
assert addon_utils.enable("blender_addon", default_set=True)
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
{code}
bpy.context.scene.render.filepath = sys.argv[2]
bpy.ops.render.render(write_still=True)
"""

if importlib.util.find_spec("bpy") is not None:
    os.environ["BLENDER_USER_RESOURCES"] = str(USER)
    os.environ.pop("OCIO", None)
    os.environ.pop("BLENDER_OCIO", None)
    import bpy

    bpy.utils.expose_bundled_modules()


def pytest_sessionfinish():
    shutil.rmtree(USER, ignore_errors=True)


@pytest.fixture
def addon(fixed_model):
    """The add-on, enabled in an empty scene, with the fixed model; gives its preferences."""
    import addon_utils

    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert addon_utils.enable("blender_addon", default_set=True)
    preferences = bpy.context.preferences.addons["blender_addon"].preferences
    preferences.model = str(fixed_model)
    yield preferences
    addon_utils.disable("blender_addon", default_set=True)


@pytest.fixture
def image(addon, plate_file):
    """The bundled plate as an image."""
    return bpy.data.images.load(str(plate_file))


@pytest.fixture
def estimated(image):
    """The same image, with its estimate."""
    bpy.ops.crf.estimate_response(image=image.name)
    return image


@pytest.fixture
def tree(addon):
    """The scene's compositor tree."""
    from blender_addon.scene.nodes.compositor import compositor_tree

    return compositor_tree(bpy.context.scene)


@pytest.fixture
def in_editor():
    """Turn an area of the window into an editor for the length of a block; gives its space."""

    @contextlib.contextmanager
    def show(kind):
        window = bpy.context.window_manager.windows[0]
        area = window.screen.areas[-1]
        area.ui_type = {"NODE_EDITOR": "CompositorNodeTree"}.get(kind, kind)
        region = next(region for region in area.regions if region.type == "UI")
        with bpy.context.temp_override(window=window, area=area, region=region):
            yield bpy.context.space_data

    return show


@pytest.fixture
def set_working_space(addon):
    """Change the working space until the end of the test; before Blender 5.0, it is the config's."""
    if bpy.app.version < (5, 0, 0):
        pytest.skip("this Blender cannot change its working space")

    def change(name):
        bpy.ops.wm.set_working_color_space(working_space=name, convert_colors=False)

    yield change
    change("Linear Rec.709")


@pytest.fixture
def interface(addon):
    """The context of an interactive session; the run that is under way at the end of the test is stopped."""
    from blender_addon.ui import running

    from .helpers import Interface

    yield Interface()
    running.stop()


@pytest.fixture
def composited(tmp_path):
    """Render what comes out of a compositor socket, on the CPU, and return its pixels, shape (H, W, 4)."""

    def render(socket, size=(256, 256)):
        tree = socket.id_data
        output = next(node for node in tree.nodes if node.type in ("GROUP_OUTPUT", "COMPOSITE"))
        tree.links.new(socket, output.inputs[0])
        return rendered(bpy.context.scene, tmp_path / "rendered.exr", size)

    return render


@pytest.fixture
def rendered_anew(tmp_path, root):
    """Save the file, render it in a new Blender that is started with a config; return its pixels and what it printed.

    Blender reads its config once, at start. The code runs there when the file has been opened.
    """

    def render(config, code=""):
        blend, exr = tmp_path / "shot.blend", tmp_path / "anew.exr"
        bpy.ops.wm.save_as_mainfile(filepath=str(blend))
        paths = os.pathsep.join(filter(None, [str(root), os.environ.get("PYTHONPATH")]))
        environment = {**os.environ, "PYTHONPATH": paths, "OCIO": str(config)}
        command = [sys.executable, "-c", ANEW.format(code=code), str(blend), str(exr)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        return read_image(exr), done.stdout + done.stderr

    return render


def rendered(scene, path, size, *, has_render=False):
    """Render a scene's compositor to an EXR file and return its pixels; of the scene, nothing by default."""
    from blender_addon.scene.nodes.compositor import compositor_tree

    render = scene.render
    render.resolution_x, render.resolution_y = size
    render.resolution_percentage = 100
    render.use_sequencer = False
    render.dither_intensity = 0
    render.compositor_device, render.compositor_precision = "CPU", "FULL"
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "IMAGE"
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth, render.image_settings.color_mode = "32", "RGBA"
    render.filepath = str(path)
    nodes = compositor_tree(scene).nodes
    for node in [node for node in nodes if node.type == "R_LAYERS" and not has_render]:
        nodes.remove(node)
    bpy.ops.render.render(write_still=True)
    return read_image(path)
