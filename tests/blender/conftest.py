"""One Blender for all tests of the add-on: it starts here, before anything else loads OpenImageIO or OpenColorIO."""

import contextlib
import importlib.util
import os
import shutil
import tempfile
from pathlib import Path

import numpy as np
import pytest

#: The user's folders, for this process and those that it starts.
USER = Path(tempfile.mkdtemp(prefix="crf_blender_user_"))

if importlib.util.find_spec("bpy") is not None:
    os.environ["BLENDER_USER_RESOURCES"] = str(USER)
    os.environ.pop("OCIO", None)
    os.environ.pop("BLENDER_OCIO", None)
    import bpy

    bpy.utils.expose_bundled_modules()


def pytest_sessionfinish():
    shutil.rmtree(USER, ignore_errors=True)


class Files:
    """Writes and reads images with OpenImageIO, as they are."""

    @staticmethod
    def write(path, pixels, **attributes):
        import OpenImageIO as oiio

        kind = {"uint8": oiio.UINT8, "uint16": oiio.UINT16, "float32": oiio.FLOAT}[str(pixels.dtype)]
        header = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], kind)
        header.attribute("oiio:UnassociatedAlpha", 1)
        for name, value in attributes.items():
            header.attribute(name.replace("__", ":"), value)
        output = oiio.ImageOutput.create(str(path))
        assert output.open(str(path), header), output.geterror()
        assert output.write_image(np.ascontiguousarray(pixels))
        output.close()
        return path

    @staticmethod
    def read(path):
        import OpenImageIO as oiio

        image = oiio.ImageBuf(str(path))
        assert not image.has_error, image.geterror()
        return image.get_pixels(oiio.FLOAT)


@pytest.fixture(scope="session")
def files():
    return Files


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


@pytest.fixture(scope="session")
def codes():
    """Code values, shape (256, 256, 3): all 8-bit codes in every channel, in different order."""
    ramp = np.arange(256, dtype=np.uint8)
    red = np.repeat(ramp[None], 256, axis=0)
    return np.stack([red, red.T, red[:, ::-1]], axis=2)


@pytest.fixture
def plate_file(tmp_path, files, codes):
    """A photograph of these code values."""
    return files.write(tmp_path / "plate.png", codes)


@pytest.fixture
def estimate(fixed_model):
    """What the estimator itself says of files, with the fixed model."""
    from crfnet_core import ResponseNetwork, estimate_response, read_photo

    network = ResponseNetwork.load(fixed_model)
    return lambda *paths: estimate_response([read_photo(path) for path in paths], network=network)


@pytest.fixture
def composited(tmp_path, files):
    """Render what comes out of a compositor socket, on the CPU, and return its pixels, shape (H, W, 4)."""

    def render(socket, size=(256, 256)):
        scene, tree = bpy.context.scene, socket.id_data
        if bpy.app.version >= (5, 0, 0):
            outputs = [node for node in tree.nodes if node.type == "GROUP_OUTPUT"]
        else:
            outputs = [node for node in tree.nodes if node.type == "COMPOSITE"]
        tree.links.new(socket, outputs[0].inputs[0])
        return rendered(scene, tmp_path / "rendered.exr", files, size)

    return render


def rendered(scene, path, files, size):
    """Render a scene's compositor to an EXR file and return its pixels."""
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
    for node in [node for node in _tree(scene).nodes if node.type == "R_LAYERS"]:
        _tree(scene).nodes.remove(node)  # nothing is to be rendered
    bpy.ops.render.render(write_still=True)
    return files.read(path)


def _tree(scene):
    return scene.compositing_node_group if bpy.app.version >= (5, 0, 0) else scene.node_tree
