"""Bake and export: files judged by their pixels, the exported config in a Blender started with it."""

import os
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from crfnet.luts.files import WRITERS, read_lut
from tests.helpers.configs import converted, loaded
from tests.helpers.folders import listed
from tests.helpers.reference_exr import read_reference

from .helpers import apply, bpy, drawn_in, labels, load, pixels_of, scene_tree
from .helpers import estimate as run

FLOAT, HALF = 1e-6, 2**-11


@pytest.mark.parametrize(("depth", "limit"), [("float", FLOAT), ("half", HALF)])
def test_bake(image, plate_file, codes, estimate, depth, limit):
    run(image, "BAKE", depth=depth, exposure=1)
    expected = 2 * estimate(plate_file).curve.inverse(codes / 255)
    _, judged = read_reference(plate_file.with_name("plate_linear.exr"))
    assert np.abs(judged - expected).max() < 2 * limit
    baked = bpy.data.images["plate_linear.exr"]
    assert baked.colorspace_settings.name == "Linear Rec.709"
    assert np.abs(pixels_of(baked)[..., :3] - expected).max() < 2 * limit


def test_export(image, plate_file, tmp_path, codes, estimate, in_editor):
    from blender_addon.ui.more.load_lut import _first_folder

    folder = tmp_path / "look"
    run(image, "EXPORT", folder=str(folder))
    assert f"OCIO={folder / 'config.ocio'}" in "".join(labels(drawn_in(image, in_editor)))  # lines may end in the path
    assert _first_folder(image) == f"{folder}{os.sep}"
    (of_config,) = (path.name for path in folder.glob("plate (*).spi1d"))
    assert set(listed(folder)) == {"config.ocio", of_config, *(f"plate{suffix}" for suffix in WRITERS)}
    expected = estimate(plate_file).curve.inverse(codes / 255)
    for suffix in WRITERS:
        assert np.abs(read_lut(folder / f"plate{suffix}").apply(codes / 255) - expected).max() < FLOAT
    light = converted(loaded(folder / "config.ocio"), "CRF plate", "scene_linear", codes / 255)
    assert np.abs(light - expected).max() < 1e-5


@pytest.mark.parametrize(("mode", "name"), [("EXPORT", "plate.cube"), ("BAKE", "plate_linear.exr")])
def test_a_plate_replaces_its_own_files_and_those_of_others_on_demand_only(image, tmp_path, mode, name):
    again, file = partial(apply, image, folder=str(tmp_path)), tmp_path / name
    run(image, mode, folder=str(tmp_path))
    for way in ("EXPORT", "BAKE", mode):
        again(way, exposure=1)
    run(image, mode, folder=str(tmp_path), exposure=2)
    file.write_bytes(b"of another")
    with pytest.raises(RuntimeError, match="exists already"):
        again(mode)
    assert file.read_bytes() == b"of another"
    again(mode, overwrite=True)
    again(mode)


def test_a_path_relative_to_the_scene_needs_a_saved_scene(addon, plate_file, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    bpy.ops.wm.read_homefile(use_empty=True)
    with pytest.raises(RuntimeError, match=r"is relative to the \.blend file: save that first"):
        run(load(plate_file), "EXPORT", folder="//renders")
    assert not (tmp_path / "renders").exists()


def test_a_blender_that_is_started_with_the_exported_config(
    image, plate_file, composited, rendered_anew, tmp_path, codes, estimate
):
    """It has the plate's color space, and AgX as before; the user's own folder stays as it is."""
    run(image, "EXPORT", folder=str(tmp_path / "look"))
    assert not Path(bpy.utils.user_resource("DATAFILES", path="colormanagement")).exists()
    node = scene_tree().nodes.new("CompositorNodeImage")
    node.image = image
    composited(node.outputs["Image"])
    code = 'bpy.data.images["plate.png"].colorspace_settings.name = "CRF plate"\n'
    code += 'bpy.context.scene.view_settings.view_transform = "AgX"'
    pixels, log = rendered_anew(tmp_path / "look" / "config.ocio", code)
    assert "error" not in log.lower(), log
    assert np.abs(pixels[..., :3] - estimate(plate_file).curve.inverse(codes / 255)).max() < 1e-5


def test_the_environments_config_is_the_base(image, tmp_path, monkeypatch):
    """A studio's ACES config has no AgX, and the exported one has all that it has."""
    studio = "ocio://studio-config-v2.1.0_aces-v1.3_ocio-v2.3"
    monkeypatch.setenv("OCIO", studio)
    run(image, "EXPORT", folder=str(tmp_path))
    names = loaded(tmp_path / "config.ocio").getColorSpaceNames()
    assert list(names) == [*loaded(studio).getColorSpaceNames(), "CRF plate"]
