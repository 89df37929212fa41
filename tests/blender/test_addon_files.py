"""Bake, colour space and export: files judged by their pixels, the colour space in a Blender started anew."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.helpers.images import read_image

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")

FLOAT, HALF = 1e-6, 2**-11

# Run in a process of its own: Blender reads its config once, at start.
SCRIPT = """
import json, sys
import bpy
bpy.utils.expose_bundled_modules()
import addon_utils

job = json.loads(sys.argv[-1])
assert addon_utils.enable("blender_addon", default_set=True)
bpy.ops.wm.open_mainfile(filepath=job["blend"])
image = bpy.data.images[job["image"]]
from blender_addon.scene.compositor import compositor_tree
tree = compositor_tree(bpy.context.scene)
output = next(node for node in tree.nodes if node.type in ("GROUP_OUTPUT", "COMPOSITE"))
for node in list(tree.nodes):
    if node != output:
        tree.nodes.remove(node)
node = tree.nodes.new("CompositorNodeImage")
node.image = image
tree.links.new(node.outputs["Image"], output.inputs[0])
render = bpy.context.scene.render
render.resolution_x = render.resolution_y = 256
render.resolution_percentage = 100
render.use_sequencer, render.dither_intensity = False, 0
render.compositor_device, render.compositor_precision = "CPU", "FULL"
if hasattr(render.image_settings, "media_type"):
    render.image_settings.media_type = "IMAGE"
render.image_settings.file_format = "OPEN_EXR"
render.image_settings.color_depth, render.image_settings.color_mode = "32", "RGB"
render.filepath = job["linear"]
bpy.ops.render.render(write_still=True)
views = []
for view in ("Standard", "AgX", "Filmic"):
    try:
        bpy.context.scene.view_settings.view_transform = view
        views.append(view)
    except TypeError:
        pass
again = bpy.ops.crf.apply_response(image=job["image"])
print("FOUND " + json.dumps({"space": image.colorspace_settings.name, "views": views, "again": list(again)}))
"""


@pytest.fixture
def image(addon, plate_file):
    return bpy.data.images.load(str(plate_file))


def run(image, **choices):
    return bpy.ops.crf.estimate_response(image=image.name, **choices)


@pytest.mark.parametrize(("depth", "limit"), [("float", FLOAT), ("half", HALF)])
def test_bake(image, plate_file, codes, estimate, depth, limit):
    assert run(image, apply="BAKE", depth=depth, exposure=1) == {"FINISHED"}
    expected = 2 * estimate(plate_file).curve.inverse(codes / 255)
    assert np.abs(read_image(plate_file.with_name("plate_linear.exr")) - expected).max() < 2 * limit
    baked = bpy.data.images["plate_linear.exr"]
    assert baked.colorspace_settings.name == "Linear Rec.709"
    pixels = np.array(baked.pixels[:]).reshape(256, 256, -1)[::-1, :, :3]
    assert np.abs(pixels - expected).max() < 2 * limit


def test_bake_overwrites_only_when_asked(image, plate_file):
    run(image, apply="BAKE")
    first = plate_file.with_name("plate_linear.exr").read_bytes()
    with pytest.raises(RuntimeError, match="exists already"):
        bpy.ops.crf.apply_response(image=image.name, exposure=1)
    assert plate_file.with_name("plate_linear.exr").read_bytes() == first
    assert bpy.ops.crf.apply_response(image=image.name, exposure=1, overwrite=True) == {"FINISHED"}
    assert plate_file.with_name("plate_linear.exr").read_bytes() != first


def test_bake_shows_the_linear_plate(image, in_editor):
    with in_editor("IMAGE_EDITOR") as space:
        space.image = image
        assert bpy.ops.crf.estimate_response(apply="BAKE") == {"FINISHED"}
        assert space.image.name == "plate_linear.exr"


def test_export(image, plate_file, tmp_path, codes, estimate):
    from crfnet.luts.files import WRITERS, read_lut

    folder = tmp_path / "look"
    assert run(image, apply="EXPORT", folder=str(folder)) == {"FINISHED"}
    assert sorted(path.name for path in folder.iterdir()) == sorted(
        ["config.ocio", *(f"plate{suffix}" for suffix in WRITERS)]
    )
    expected = estimate(plate_file).curve.inverse(codes / 255)
    for suffix in WRITERS:
        assert np.abs(read_lut(folder / f"plate{suffix}").apply(codes / 255) - expected).max() < FLOAT
    assert np.abs(converted(folder / "config.ocio", codes) - expected).max() < 1e-5
    with pytest.raises(RuntimeError, match="exists already"):
        run(image, apply="EXPORT", folder=str(folder))


def converted(config, codes, space="CRF plate"):
    import PyOpenColorIO as OCIO

    pixels = (codes / np.float32(255)).astype(np.float32)
    processor = OCIO.Config.CreateFromFile(str(config)).getProcessor(space, "scene_linear")
    processor.getOptimizedCPUProcessor(OCIO.OPTIMIZATION_NONE).applyRGB(pixels)
    return pixels


def test_files_need_a_folder_that_can_be_written(image, tmp_path):
    (tmp_path / "file").write_text("")
    for mode in ("BAKE", "EXPORT", "COLORSPACE"):
        with pytest.raises(RuntimeError, match="is not a folder"):
            run(image, apply=mode, folder=str(tmp_path / "file" / "look"))
    assert "camera_response" not in image


@pytest.mark.parametrize("choice", [{"folder": "//renders"}, {"prior": "file", "prior_file": "//prior.json"}])
def test_a_path_relative_to_the_scene_needs_a_saved_scene(addon, plate_file, choice, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    bpy.ops.wm.read_homefile(use_empty=True)
    image = bpy.data.images.load(str(plate_file))
    with pytest.raises(RuntimeError, match=r"is relative to the \.blend file: save that first"):
        bpy.ops.crf.estimate_response(image=image.name, apply="EXPORT", **choice)
    assert not (tmp_path / "renders").exists()


def test_color_space_after_a_restart(image, plate_file, tmp_path, codes, estimate, root):
    from blender_addon.scene.color_management import user_folder

    expected = estimate(plate_file).curve.inverse(codes / 255)
    try:
        assert run(image, apply="COLORSPACE") == {"FINISHED"}
        assert image.colorspace_settings.name == "sRGB"  # not there yet
        image.use_fake_user = True
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
        found = restarted(tmp_path, root)
        linear = read_image(tmp_path / "linear.exr")
        assert np.abs(converted(user_folder() / "config.ocio", codes) - expected).max() < 1e-5
    finally:
        bpy.ops.crf.restore_config()
    assert found == {"space": "CRF plate", "views": ["Standard", "AgX", "Filmic"], "again": ["FINISHED"]}
    assert np.abs(linear - expected).max() < 1e-5
    assert not user_folder().exists()  # an empty one would put Blender into its fallback mode


def restarted(folder, root):
    """Open the saved file in a new Blender and return what it found there."""
    job = {"blend": str(folder / "shot.blend"), "image": "plate.png", "linear": str(folder / "linear.exr")}
    paths = os.pathsep.join(filter(None, [str(root), os.environ.get("PYTHONPATH")]))
    environment = {**os.environ, "PYTHONPATH": paths}
    command = [sys.executable, "-c", SCRIPT, json.dumps(job)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "error" not in done.stderr.lower(), done.stderr
    return json.loads(next(line for line in done.stdout.splitlines() if line.startswith("FOUND "))[6:])


def test_a_config_of_somebody_else_is_merged_into_and_restored(image, tmp_path, codes, estimate, plate_file):
    import PyOpenColorIO as OCIO

    from crfnet.configs.portable import portable_config

    config = tmp_path / "studio" / "config.ocio"
    config.parent.mkdir()
    config.write_text(portable_config([]).serialize())
    before = config.read_bytes()
    for _ in range(2):
        assert run(image, apply="COLORSPACE", folder=str(config.parent)) == {"FINISHED"}
    names = [space.getName() for space in OCIO.Config.CreateFromFile(str(config)).getColorSpaces()]
    assert names.count("CRF plate") == 1
    expected = estimate(plate_file).curve.inverse(codes / 255)
    assert np.abs(converted(config, codes) - expected).max() < 1e-5
    assert [path.read_bytes() for path in config.parent.glob("config.before*")] == [before]
    assert bpy.ops.crf.restore_config(folder=str(config.parent)) == {"FINISHED"}
    assert config.read_bytes() == before
    with pytest.raises(RuntimeError, match="nothing to restore"):
        bpy.ops.crf.restore_config(folder=str(config.parent))


def test_a_config_changed_since_is_not_restored(image, tmp_path):
    run(image, apply="COLORSPACE", folder=str(tmp_path / "ours"))
    config = tmp_path / "ours" / "config.ocio"
    config.write_text(config.read_text() + "\n# mine\n")
    with pytest.raises(RuntimeError, match="changed by another program"):
        bpy.ops.crf.restore_config(folder=str(config.parent))
    assert config.read_text().endswith("# mine\n")


def test_a_config_that_does_not_load_is_left_alone(image, tmp_path):
    config = tmp_path / "broken" / "config.ocio"
    config.parent.mkdir()
    config.write_text("no config")
    with pytest.raises(RuntimeError, match="refuses this config"):
        run(image, apply="COLORSPACE", folder=str(config.parent))
    assert [path.name for path in config.parent.iterdir()] == ["config.ocio"]
    assert config.read_text() == "no config"
    assert "camera_response" not in image


def test_the_environments_config_is_never_touched(image, tmp_path, monkeypatch):
    """Blender looks nowhere else then, so a new config is written and the artist is told to name it."""
    from crfnet.configs.portable import portable_config

    studio = tmp_path / "studio.ocio"
    studio.write_text(portable_config([]).serialize())
    before = studio.read_bytes()
    monkeypatch.setenv("OCIO", str(studio))
    assert run(image, apply="COLORSPACE", folder=str(tmp_path / "mine")) == {"FINISHED"}
    assert studio.read_bytes() == before
    assert Path(tmp_path, "mine", "config.ocio").is_file()


@pytest.mark.parametrize("is_users", [True, False])
def test_an_environment_that_names_the_usual_config_demands_nothing(addon, monkeypatch, is_users):
    """Blender 5.2 sets OCIO to its own choice, and programs that it starts inherit it."""
    from blender_addon.scene import color_management

    usual = color_management.running_config()
    monkeypatch.setenv("OCIO", str(color_management.user_folder() / "config.ocio") if is_users else usual)
    assert color_management.environment_config() == ""
    assert color_management.running_config() == usual
