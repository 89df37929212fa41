"""Before and after in the Image Editor, and the eyedropper for gray: what is seen, and what never changes."""

import importlib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from tests.helpers.images import write_image

from .helpers import bpy, comparison, curve_of, drawn_here, load, load_sequence, operators, pixels_of, plates, show
from .helpers import estimate as run

pytestmark = pytest.mark.usefixtures("estimated")

#: Blender's keymaps that count in an Image Editor.
KEYMAPS = ("Window", "Screen", "Frames", "View2D", "Image", "Image Generic", "Image Paint", "UV Editor", "Mask Editing")


def names():
    return [image.name for image in bpy.data.images]


@pytest.mark.parametrize("is_packed", [False, True])
def test_the_linear_plate_is_shown_and_kept_for_the_next_time(image, plate_file, codes, estimate, in_editor, is_packed):
    before = names()
    if is_packed:
        image.pack()
    expected = estimate(plate_file).curve.inverse(codes / 255)
    with in_editor("IMAGE_EDITOR") as space:
        space.image = image
        show(after=True)
        assert np.abs(pixels_of(space.image)[..., :3] - expected).max() < 1e-6
        assert space.image.colorspace_settings.name == "Linear Rec.709"
        assert plates.active_datablock(bpy.context) == image  # the panel still shows the plate
        assert image.colorspace_settings.name == "sRGB"
        image.camera_response_settings.exposure = 1
        assert bpy.app.timers.is_registered(comparison.renew)  # by and by
        comparison.renew()
        linear = space.image
        assert not linear.is_dirty  # or Blender would ask to save it
        assert np.abs(pixels_of(space.image)[..., :3] - 2 * expected).max() < 2e-6
        assert len(names()) == len(before) + 1
        show(after=False)
        assert space.image == image
        linear.pixels[0] = 0.25  # not computed anew
        bpy.ops.crf.compare()  # as the key does
        assert space.image == linear
        assert linear.name == ".Linear view of plate.png"
        assert linear.pixels[0] == 0.25
        bpy.ops.crf.compare()
        assert space.image == image


def test_the_key_of_the_switch_is_free_in_blenders_keymap_and_absent_without_a_window(addon, monkeypatch):
    import addon_utils

    from blender_addon.ui.image_editor import image_tools

    monkeypatch.syspath_prepend(Path(bpy.utils.system_resource("SCRIPTS"), "presets", "keyconfig"))
    generated = importlib.import_module("keymap_data.blender_default").generate_keymaps()
    used = [event for name, _, content in generated if name in KEYMAPS for _, event, _ in content["items"]]
    assert len(used) > 100
    assert not [event for event in used if event["type"] == "Z" and event.keys() & {"shift", "any"} and len(event) == 3]
    keymaps = bpy.context.window_manager.keyconfigs.addon.keymaps
    assert "Image" not in keymaps  # in the background
    image_tools.add_key()
    (item,) = keymaps["Image"].keymap_items
    assert (item.idname, item.type, item.shift) == ("crf.compare", "Z", True)
    assert not item.properties.is_property_set("is_after")  # so it switches
    addon_utils.disable("blender_addon")
    assert not keymaps["Image"].keymap_items


@pytest.mark.parametrize(("kind", "editor"), [("image", "IMAGE_EDITOR"), ("clip", "CLIP_EDITOR")])
def test_a_baked_plate_leads_back_to_its_plate(addon, plate_file, in_editor, kind, editor):
    plate = load(plate_file, kind)
    with in_editor(editor) as space:
        setattr(space, kind, plate)
        assert not bpy.ops.crf.show_plate.poll()
        run(plate, "BAKE")
        assert getattr(space, kind) != plate
        assert ("crf.show_plate", "LOOP_BACK") in operators(drawn_here())
        assert bpy.ops.crf.show_plate() == {"FINISHED"}
        assert getattr(space, kind) == plate
        assert "crf.show_plate" not in str(drawn_here())


def test_of_a_sequence_it_is_the_frame_that_the_editor_shows(addon, codes, tmp_path, in_editor):
    """Not the one that Blender has read last, for another editor or a node; a missing frame is named."""
    for number in (1, 2, 4):
        write_image(tmp_path / f"shot.{number:04d}.png", np.roll(codes, number, axis=0))
    image = load_sequence(tmp_path / "shot.0001.png")
    run(image)
    curve = curve_of(image)
    with in_editor("IMAGE_EDITOR") as space:
        space.image, space.image_user.frame_duration = image, 4
        for number in (2, 4, 1):
            bpy.context.scene.frame_set(number)
            show(after=True)
            expected = curve.inverse(np.roll(codes, number, axis=0) / 255)
            assert np.abs(pixels_of(space.image)[..., :3] - expected).max() < 1e-6
            show(after=False)
        show(after=True)
        bpy.context.scene.frame_set(4)  # while the linear plate is shown
        assert bpy.app.timers.is_registered(comparison.renew)
        comparison.renew()
        assert np.abs(pixels_of(space.image)[..., :3] - curve.inverse(np.roll(codes, 4, axis=0) / 255)).max() < 1e-6
        for number in (0, 3):
            bpy.context.scene.frame_set(number)
            comparison.renew()
            assert not pixels_of(space.image).any()  # a missing frame is empty
        bpy.context.scene.frame_set(2)
        comparison.renew()  # it comes back
        assert np.abs(pixels_of(space.image)[..., :3] - curve.inverse(np.roll(codes, 2, axis=0) / 255)).max() < 1e-6
        show(after=False)
        bpy.context.scene.frame_set(3)
        with pytest.raises(RuntimeError, match=r"shot\.0003\.png"):
            show(after=True)
        assert space.image == image


@pytest.mark.parametrize("occasion", ["save", "undo", "disable"])
def test_it_never_reaches_the_file(image, in_editor, tmp_path, occasion):
    import addon_utils

    bpy.ops.ed.undo_push(message="before")
    bpy.ops.ed.undo_push(message="after")
    with in_editor("IMAGE_EDITOR") as space:
        space.image = image
        show(after=True)
        if occasion == "save":
            bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
        elif occasion == "undo":
            bpy.ops.ed.undo()
        else:
            addon_utils.disable("blender_addon")
            addon_utils.enable("blender_addon")
    assert names() == ["plate.png"]
    if occasion != "undo":
        assert space.image.name == "plate.png"


def test_gray_is_the_mean_of_a_few_pixels():
    from blender_addon.ui.image_editor.image_tools import mean_around
    from blender_addon.work.errors import AddonError

    codes = np.zeros((100, 200, 4), np.float32)
    codes[50:, 100:, :3] = (0.4, 0.5, 0.6)
    codes[..., 3] = 1
    assert mean_around(codes, (0.75, 0.75)) == pytest.approx(0.5)
    assert mean_around(codes, (0.25, 0.75)) == 0
    assert mean_around(codes, (0.9999, 0.9999)) == pytest.approx(0.5)  # at a corner
    for place in ((-0.001, 0.5), (0.5, 1.0), (2, 2)):
        with pytest.raises(AddonError, match="click inside the plate"):
            mean_around(codes, place)


class Picking:
    """Stands for the context of an Image Editor whose view shows the picture on 100 x 100 pixels of the screen."""

    def __init__(self, image):
        self.space_data = SimpleNamespace(image=image, image_user=None, type="IMAGE_EDITOR")
        view = SimpleNamespace(region_to_view=lambda x, y: (x / 100, y / 100))
        region = SimpleNamespace(type="WINDOW", x=40, y=20, view2d=view)
        self.area = SimpleNamespace(regions=[region])
        self.window = self.workspace = self.window_manager = self
        self.calls = []

    def __getattr__(self, name):
        return lambda *arguments: self.calls.append((name, *arguments))


@pytest.fixture
def picker(addon):
    from blender_addon.ui.image_editor.image_tools import CRF_OT_pick_gray

    class Driven:
        names = ("invoke", "modal", "cancel", "poll", "_pick")
        invoke, modal, cancel, poll, _pick = (vars(CRF_OT_pick_gray)[name] for name in names)

        def report(self, kind, text):
            """What is reported is not looked at."""

        @staticmethod
        def poll_message_set(why):
            """The tooltip is Blender's own matter."""

    return Driven()


def test_a_click_picks_gray(picker, image, codes):
    context = Picking(image)
    assert picker.invoke(context, None) == {"RUNNING_MODAL"}
    assert picker.modal(context, SimpleNamespace(type="MOUSEMOVE", value="NOTHING")) == {"PASS_THROUGH"}
    click = SimpleNamespace(type="LEFTMOUSE", value="PRESS", mouse_x=40 + 25, mouse_y=20 + 75)
    assert picker.modal(context, click) == {"FINISHED"}
    settings = image.camera_response_settings
    column, row = 64, 255 - 192  # three quarters from the bottom
    assert settings.gray == pytest.approx(codes[row - 2 : row + 3, column - 2 : column + 3].mean() / 255, abs=1e-6)
    assert settings.anchor == "GRAY"
    assert context.calls[-2:] == [("cursor_modal_restore",), ("status_text_set", None)]


@pytest.mark.parametrize(
    ("shown", "key"),
    [
        (SimpleNamespace(type="IMAGE_EDITOR", image=None), "LEFTMOUSE"),
        (SimpleNamespace(type="VIEW_3D"), "LEFTMOUSE"),
        (None, "ESC"),
    ],
)
def test_nothing_is_picked_after_esc_or_in_an_editor_that_shows_no_plate_any_more(picker, image, shown, key):
    context = Picking(image)
    picker.invoke(context, None)
    context.space_data = shown or context.space_data
    pressed = SimpleNamespace(type=key, value="PRESS", mouse_x=65, mouse_y=95)
    assert picker.modal(context, pressed) == {"CANCELLED"}
    assert image.camera_response_settings.anchor == "WHITE"
    assert context.calls[-2:] == [("cursor_modal_restore",), ("status_text_set", None)]
