"""The operator's estimate is the API's, kept in the .blend file, for every kind of plate; errors are one sentence."""

import dataclasses
import subprocess
import sys

import numpy as np
import pytest

from crfnet_core.photograph.metadata import Device
from crfnet_core.posterior import Prior
from tests.helpers.images import read_image, write_image

from .helpers import bpy, load, load_sequence, paint, reopen, stored_estimate, words_in

EDITORS = {"IMAGE_EDITOR": "image", "CLIP_EDITOR": "clip"}


def assert_stored(datablock, expected):
    """The estimate that is stored is this one, number by number."""
    found = stored_estimate.restored(datablock)
    np.testing.assert_equal(dataclasses.asdict(found), dataclasses.asdict(expected))
    assert found.verdict == expected.verdict


def test_enabled_and_disabled_twice(addon):
    import addon_utils

    for _ in range(2):
        addon_utils.disable("blender_addon")
        assert not hasattr(bpy.types.Image, "camera_response_settings")
        assert not hasattr(bpy.types, "CRF_OT_estimate_response")
        addon_utils.enable("blender_addon")
        assert hasattr(bpy.types, "CRF_OT_estimate_response")


def test_it_is_the_apis_survives_in_the_file_and_is_shown_without_the_plate(
    image, plate_file, tmp_path, estimate, in_editor
):
    bpy.ops.crf.estimate_response(image=image.name, exposure=0.5)
    image.use_fake_user = True
    reopen(tmp_path / "shot.blend")
    image = bpy.data.images["plate.png"]
    assert_stored(image, estimate(plate_file))
    assert image.camera_response_settings.exposure == 0.5
    plate_file.rename(plate_file.with_name("gone.png"))
    assert f"error {image.camera_response.expected_error:.2f}" in words_in(image, in_editor)
    with pytest.raises(RuntimeError, match="does not exist"):
        bpy.ops.crf.estimate_response(image=image.name)


def test_the_prior_the_metadata_and_the_device_follow_the_settings(image, plate_file, estimate):
    image.camera_response_settings.prior = "any"
    for device, expected in (("phone", Device.PHONE), ("file", None)):
        bpy.ops.crf.estimate_response(image=image.name, ignore_metadata=True, device=device)
        assert_stored(image, estimate(plate_file, prior=Prior.load("any"), use_metadata=False, device=expected))
        settings = image.camera_response_settings
        assert (settings.prior, settings.ignore_metadata, settings.device) == ("any", True, device)


def test_undo_takes_everything_back(image):
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.crf.estimate_response(image=image.name, apply="NODES")
    bpy.ops.ed.undo_push(message="estimate")
    assert any(group.name.startswith("Camera Response plate") for group in bpy.data.node_groups)
    assert bpy.context.scene.render.film_transparent
    bpy.ops.ed.undo()
    assert not bpy.context.scene.render.film_transparent
    image = bpy.data.images["plate.png"]
    assert "camera_response" not in image
    assert image.colorspace_settings.name == "sRGB"
    assert not [group for group in bpy.data.node_groups if group.name.startswith("Camera")]
    bpy.ops.ed.redo()
    assert "camera_response" in bpy.data.images["plate.png"]


@pytest.mark.parametrize("editor", EDITORS)
def test_from_the_editors(image, plate_file, in_editor, editor):
    with in_editor(editor) as space:
        assert not bpy.ops.crf.estimate_response.poll()
        datablock = load(plate_file, EDITORS[editor])
        setattr(space, EDITORS[editor], datablock)
        assert bpy.ops.crf.estimate_response.poll()
        assert not bpy.ops.crf.apply_response.poll()
        assert bpy.ops.crf.estimate_response("INVOKE_DEFAULT", apply="NODES") == {"FINISHED"}  # no interface: execute
        assert bpy.ops.crf.apply_response.poll()
        if editor == "IMAGE_EDITOR":
            datablock.pixels[0] = 0.5  # unsaved changes
            assert not bpy.ops.crf.apply_response.poll()
    assert "camera_response" in datablock


@pytest.mark.parametrize("kind", ["image", "clip"])
def test_a_sequence_of_which_a_frame_is_missing(addon, tmp_path, codes, estimate, kind):
    images = {number: np.roll(codes, number, axis=0) for number in (7, 9, 10)}
    frames = [write_image(tmp_path / f"shot.{number:04d}.png", pixels) for number, pixels in images.items()]
    datablock = load(frames[0], kind) if kind == "clip" else load_sequence(frames[0])
    assert bpy.ops.crf.estimate_response(**{kind: datablock.name}, apply="BAKE", depth="float") == {"FINISHED"}
    expected = estimate(*frames)
    assert_stored(datablock, expected)
    linear = sorted(path.name for path in tmp_path.glob("*.exr"))
    assert linear == ["shot_linear.0007.exr", "shot_linear.0009.exr", "shot_linear.0010.exr"]
    pixels = read_image(tmp_path / "shot_linear.0010.exr")
    assert np.abs(pixels - expected.curve.inverse(images[10] / 255)).max() < 1e-6
    collection = bpy.data.images if kind == "image" else bpy.data.movieclips
    baked = collection["shot_linear.0007.exr"]
    assert baked.source == "SEQUENCE"
    assert baked.colorspace_settings.name == "Linear Rec.709"


def test_a_packed_image(image, plate_file, estimate):
    expected = estimate(plate_file)
    image.pack()
    plate_file.unlink()
    bpy.ops.crf.estimate_response(image=image.name)
    assert_stored(image, expected)
    with pytest.raises(RuntimeError, match="choose one under Folder"):
        bpy.ops.crf.apply_response(image=image.name, apply="BAKE")


@pytest.mark.parametrize("color_space", ["sRGB", "Non-Color"])
def test_a_generated_image(addon, codes, estimate, tmp_path, color_space):
    """Its pixels are code values, whatever its color space, and it has no metadata."""
    image = bpy.data.images.new("painted", 256, 256)
    image.colorspace_settings.name = color_space
    paint(image, codes / 255)
    bpy.ops.crf.estimate_response(image=image.name)
    assert_stored(image, estimate(write_image(tmp_path / "painted.png", codes), use_metadata=False))


def test_errors_are_one_sentence_and_leave_nothing(addon, tmp_path, codes):
    small = load(write_image(tmp_path / "small.png", codes[:100]))
    float_image = bpy.data.images.new("float", 256, 256, float_buffer=True)
    for name, words in ((small.name, "at least 227 x 227"), (float_image.name, "linear"), ("nothing", "no image")):
        with pytest.raises(RuntimeError, match=words) as problem:
            bpy.ops.crf.estimate_response(image=name)
        assert "Traceback" not in str(problem.value)
        assert len(str(problem.value).strip().splitlines()) == 1
    with pytest.raises(RuntimeError, match="has no estimate yet"):
        bpy.ops.crf.apply_response(image=small.name)
    with pytest.raises(RuntimeError, match="No plate is active"):
        bpy.ops.crf.estimate_response()
    assert not bpy.data.node_groups


MISSING = """
import sys
import bpy
sys.modules[sys.argv[-1]] = None
import addon_utils
assert addon_utils.enable("blender_addon", default_set=True)
from blender_addon.scene.plates import obstacle
image = bpy.data.images.load(sys.argv[-2])
print("PANEL", obstacle(image))
try:
    bpy.ops.crf.estimate_response(image=image.name)
except RuntimeError as problem:
    print("FOUND", problem)
assert "camera_response" not in image
addon_utils.disable("blender_addon", default_set=True)
assert not hasattr(bpy.types, "CRF_OT_estimate_response")
"""


@pytest.mark.parametrize(
    ("library", "remedy"),
    [
        ("onnxruntime", "install the add-on again, from the zip for this system and Python"),
        ("crfnet", "install the add-on again"),
        ("crfnet_core", "install the add-on again"),
        ("PyOpenColorIO", "use Blender from blender.org"),
    ],
)
def test_without_a_library_it_is_enabled_and_says_what_is_missing(plate, root, tmp_path, library, remedy):
    code = f"import sys; sys.path.insert(0, {str(root)!r})\n{MISSING}"
    command = [sys.executable, "-c", code, str(plate), library]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for beginning in ("PANEL", "FOUND"):
        (line,) = (line for line in done.stdout.splitlines() if line.startswith(beginning))
        assert library in line
        assert remedy in line
    assert "Traceback" not in done.stdout + done.stderr


def test_enabling_loads_no_estimator(root, tmp_path):
    code = (
        f"import sys; sys.path.insert(0, {str(root)!r}); import bpy, addon_utils;"
        " assert addon_utils.enable('blender_addon', default_set=True);"
        " print({'onnxruntime', 'crfnet_core', 'crfnet', 'PyOpenColorIO', 'OpenImageIO'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300, cwd=tmp_path)
    assert done.stdout.strip().endswith("set()"), done.stdout + done.stderr
