"""What the panel shows: settings, words and the icon of the response."""

import numpy as np
import pytest

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")


@pytest.fixture
def image(addon, plate_file):
    image = bpy.data.images.load(str(plate_file))
    bpy.ops.crf.estimate_response(image=image.name)
    return image


class Layout:
    """Stands for a layout; records what is drawn into it."""

    def __init__(self):
        self.drawn = []

    def panel(self, name, **options):
        """An open panel: its header and its body."""
        return self, self

    def __getattr__(self, name):
        def draw(*arguments, **options):
            self.drawn.append((name, *arguments, *options.values()))
            return self

        return draw


class Panel:
    def __init__(self):
        self.layout = Layout()


@pytest.mark.parametrize("mode", ["NODES", "COLORSPACE", "BAKE", "EXPORT"])
def test_it_draws_every_mode(image, in_editor, mode):
    from blender_addon.ui.panel import ResponsePanel

    image.camera_response_settings.apply = mode
    panel = Panel()
    with in_editor("IMAGE_EDITOR") as space:
        space.image = image
        ResponsePanel.draw(panel, bpy.context)
    texts = " ".join(str(part) for entry in panel.layout.drawn for part in entry[1:] if part not in ("NONE", "BLANK1"))
    words = " ".join(entry[1] for entry in panel.layout.drawn if entry[0] == "label")
    assert "windows agree" in words
    assert "E_est" in words
    assert "The estimate is" in words
    assert "Most likely" in words
    assert " stop " in words
    assert "ignore_metadata" in texts
    assert "crf.apply_response" in texts
    assert ("overwrite" in texts) == (mode in ("BAKE", "EXPORT"))


def test_every_property_that_it_draws_exists(image, in_editor):
    from blender_addon.ui.panel import ResponsePanel

    panel = Panel()
    with in_editor("IMAGE_EDITOR") as space:
        space.image = image
        ResponsePanel.draw(panel, bpy.context)
    for kind, *arguments in panel.layout.drawn:
        if kind == "prop":
            assert arguments[1] in arguments[0].bl_rna.properties


def test_the_file_of_the_prior_is_asked_for_when_it_is_needed(image, in_editor):
    from blender_addon.ui.panel import ResponsePanel

    for prior in ("camera", "any", "file"):
        image.camera_response_settings.prior = prior
        panel = Panel()
        with in_editor("IMAGE_EDITOR") as space:
            space.image = image
            ResponsePanel.draw(panel, bpy.context)
        drawn = [entry[2] for entry in panel.layout.drawn if entry[0] == "prop"]
        assert ("prior_file" in drawn) == (prior == "file")


@pytest.mark.parametrize("editor", ["IMAGE_EDITOR", "CLIP_EDITOR", "NODE_EDITOR"])
def test_it_says_what_to_do_without_a_plate(addon, in_editor, editor):
    from blender_addon.scene.plates import OPEN_A_PLATE
    from blender_addon.ui.panel import ResponsePanel

    panel = Panel()
    with in_editor(editor):
        assert ResponsePanel.poll(bpy.context)
        ResponsePanel.draw(panel, bpy.context)
    assert ("label", OPEN_A_PLATE[editor], "INFO") in panel.layout.drawn


def test_the_icon_is_drawn_once_per_estimate(image):
    from blender_addon.ui import panel

    panel.curve_icon(image)
    panel.curve_icon(image)
    (preview,) = panel._previews.values()
    assert tuple(preview.image_size) == (256, 256)
    assert np.ptp(preview.image_pixels_float[:]) > 0.5
