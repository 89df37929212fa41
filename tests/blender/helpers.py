"""What tests of the add-on do in Blender; where there is none, importing this skips the module that does."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")

from blender_addon.scene import plates as plates  # noqa: E402 - after the skip
from blender_addon.scene import stored_estimate as stored_estimate  # noqa: E402
from blender_addon.scene.nodes import compositor as compositor  # noqa: E402
from blender_addon.scene.nodes.compositor import compositor_tree as compositor_tree  # noqa: E402
from blender_addon.ui.image_editor import comparison as comparison  # noqa: E402

IS_BLENDER_5 = bpy.app.version >= (5, 0, 0)


def load(path, kind="image"):
    """Open a file as an image or as a clip."""
    return (bpy.data.images if kind == "image" else bpy.data.movieclips).load(str(path))


def load_sequence(path):
    """Open the first frame of a sequence as an image."""
    image = load(path)
    image.source = "SEQUENCE"
    return image


def paint(image, colors):
    """Give an image of 256 x 256 these values, shape (256, 256, 3) or with alpha, the top row first."""
    pixels = np.ones((256, 256, 4), np.float32)
    pixels[..., : colors.shape[2]] = colors[::-1]
    image.pixels.foreach_set(pixels.ravel())


def pixels_of(image):
    """The pixels of a float image, shape (H, W, 4), the top row first."""
    width, height = image.size
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(height, width, -1)[::-1]


def estimate(datablock, mode="ESTIMATE", **choices):
    """Estimate the response of an image or a clip, and make of it what `mode` says."""
    kind = "clip" if isinstance(datablock, bpy.types.MovieClip) else "image"
    assert bpy.ops.crf.estimate_response(**{kind: datablock.name}, apply=mode, **choices) == {"FINISHED"}


def apply(image, mode="NODES", **choices):
    assert bpy.ops.crf.apply_response(image=image.name, apply=mode, **choices) == {"FINISHED"}


def curve_of(datablock):
    return stored_estimate.restored(datablock).curve


def scene_tree():
    return compositor_tree(bpy.context.scene)


def groups(tree):
    return [node for node in tree.nodes if node.type == "GROUP"]


def group_node(part="Camera Response"):
    """The only node of the scene's compositor tree whose group has this in its name."""
    (node,) = (node for node in groups(scene_tree()) if part in node.node_tree.name)
    return node


def output():
    """The node whose input the scene's compositor renders."""
    return next(node for node in scene_tree().nodes if node.type in ("GROUP_OUTPUT", "COMPOSITE"))


def reopen(path):
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.open_mainfile(filepath=str(path))


def show(after):
    """Show the linear plate in the Image Editor, or the plate again."""
    assert bpy.ops.crf.compare(is_after=after) == {"FINISHED"}


def linear_shown(image, in_editor):
    """The pixels that "Linear" shows of a plate in the Image Editor, which then shows the plate again."""
    with in_editor("IMAGE_EDITOR") as space:
        space.image = image
        show(after=True)
        found = pixels_of(space.image)
        show(after=False)
        assert space.image == image
    return found


class Interface:
    """Stands for the context of an interactive session, and records what an operator does to it."""

    def __init__(self):
        self.window = object()
        self.window_manager = self.workspace = self
        self.space_data = None
        self.scene = bpy.context.scene
        self.timers, self.status, self.progress, self.handlers, self.redrawn = [], [], [], [], []
        region = SimpleNamespace(type="UI", tag_redraw=lambda: self.redrawn.append("UI"))
        picture = SimpleNamespace(type="WINDOW", tag_redraw=lambda: self.redrawn.append("WINDOW"))
        area = SimpleNamespace(type="IMAGE_EDITOR", regions=[region, picture])
        self.windows = [SimpleNamespace(screen=SimpleNamespace(areas=[area]))]

    def event_timer_add(self, seconds, *, window):
        self.timers.append(seconds)
        return seconds

    def event_timer_remove(self, timer):
        self.timers.remove(timer)

    def modal_handler_add(self, operator):
        self.handlers.append(operator)

    def status_text_set(self, text):
        self.status.append(text)

    def progress_begin(self, first, last):
        self.progress.append(first)

    def progress_update(self, percent):
        self.progress.append(percent)

    def progress_end(self):
        self.progress.append(None)


class Layout:
    """Stands for a layout; records what is drawn and set, and knows what a real layout can draw."""

    def __init__(self):
        vars(self)["drawn"] = []

    def __setattr__(self, name, value):
        self.drawn.append(("set", name, value))
        vars(self)[name] = value

    def panel(self, name, **options):
        """An open panel: its header and its body."""
        return self, self

    def __getattr__(self, name):
        function = bpy.types.UILayout.bl_rna.functions[name]

        def draw(*arguments, **options):
            assert options.keys() <= set(function.parameters.keys()), (name, options)
            if "icon" in options:
                assert options["icon"] in function.parameters["icon"].enum_items, (name, options)
            self.drawn.append((name, *arguments, *options.values()))
            return self

        return draw


class Panel:
    def __init__(self):
        self.layout = Layout()


def drawn_in(image, in_editor):
    """What the panel of an Image Editor draws for an image."""
    with in_editor("IMAGE_EDITOR") as space:
        space.image = image
        return drawn_here()


def drawn_here():
    """What the panel of the active editor draws."""
    from blender_addon.ui.panel import ResponsePanel

    panel = Panel()
    ResponsePanel.draw(panel, bpy.context)
    return panel.layout.drawn


def labels(drawn):
    return [entry[1] for entry in drawn if entry[0] == "label"]


def words_in(image, in_editor):
    """The words of the panel of an Image Editor for an image, in one line."""
    return " ".join(labels(drawn_in(image, in_editor)))


def operators(drawn):
    return [entry[1:3] for entry in drawn if entry[0] == "operator"]
