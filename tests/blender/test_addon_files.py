"""Bake and export: files judged by their pixels, the exported config in a Blender started with it."""

from pathlib import Path

import numpy as np
import pytest

from tests.helpers.reference_exr import read_reference

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")

FLOAT, HALF = 1e-6, 2**-11


def run(image, **choices):
    return bpy.ops.crf.estimate_response(image=image.name, **choices)


@pytest.mark.parametrize(("depth", "limit"), [("float", FLOAT), ("half", HALF)])
def test_bake(image, plate_file, codes, estimate, depth, limit):
    assert run(image, apply="BAKE", depth=depth, exposure=1) == {"FINISHED"}
    expected = 2 * estimate(plate_file).curve.inverse(codes / 255)
    _, judged = read_reference(plate_file.with_name("plate_linear.exr"))
    assert np.abs(judged - expected).max() < 2 * limit
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
    for mode in ("BAKE", "EXPORT"):
        with pytest.raises(RuntimeError, match="is not a folder"):
            run(image, apply=mode, folder=str(tmp_path / "file" / "look"))
    assert "camera_response" not in image


def test_a_path_relative_to_the_scene_needs_a_saved_scene(addon, plate_file, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    bpy.ops.wm.read_homefile(use_empty=True)
    image = bpy.data.images.load(str(plate_file))
    with pytest.raises(RuntimeError, match=r"is relative to the \.blend file: save that first"):
        bpy.ops.crf.estimate_response(image=image.name, apply="EXPORT", folder="//renders")
    assert not (tmp_path / "renders").exists()


def test_a_blender_that_is_started_with_the_exported_config(
    image, plate_file, composited, rendered_anew, tmp_path, codes, estimate
):
    """It has the plate's color space, and AgX as before; the user's own folder stays as it is."""
    from blender_addon.scene.compositor import compositor_tree

    assert run(image, apply="EXPORT", folder=str(tmp_path / "look")) == {"FINISHED"}
    assert not Path(bpy.utils.user_resource("DATAFILES", path="colormanagement")).exists()
    node = compositor_tree(bpy.context.scene).nodes.new("CompositorNodeImage")
    node.image = image
    composited(node.outputs["Image"])
    code = 'bpy.data.images["plate.png"].colorspace_settings.name = "CRF plate"\n'
    code += 'bpy.context.scene.view_settings.view_transform = "AgX"'
    pixels, log = rendered_anew(tmp_path / "look" / "config.ocio", code)
    assert "error" not in log.lower(), log
    assert np.abs(pixels[..., :3] - estimate(plate_file).curve.inverse(codes / 255)).max() < 1e-5


def test_the_environments_config_is_the_base(image, tmp_path, monkeypatch):
    """A studio's ACES config has no AgX, and the exported one has all that it has."""
    import PyOpenColorIO as OCIO

    studio = tmp_path / "studio.ocio"
    studio.write_text(OCIO.Config.CreateFromBuiltinConfig("studio-config-v2.1.0_aces-v1.3_ocio-v2.3").serialize())
    before = studio.read_bytes()
    monkeypatch.setenv("OCIO", str(studio))
    assert run(image, apply="EXPORT", folder=str(tmp_path / "mine")) == {"FINISHED"}
    assert studio.read_bytes() == before
    names = OCIO.Config.CreateFromFile(str(tmp_path / "mine" / "config.ocio")).getColorSpaceNames()
    assert list(names) == [*OCIO.Config.CreateFromFile(str(studio)).getColorSpaceNames(), "CRF plate"]
