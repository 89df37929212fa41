"""Nothing in the scene changes without the user's word: Estimate Only, verdicts, problems, and no redo panel."""

import dataclasses

import pytest

from tests.helpers.images import write_image

from .helpers import IS_BLENDER_5, apply, bpy, estimate, load


@pytest.fixture
def untrusted(image, monkeypatch):
    """The image, whose estimates are not to be trusted."""
    from blender_addon.work import run
    from crfnet_core.posterior import Verdict

    estimate_files = run.estimate_files

    def doubtful(*arguments, **options):
        found = estimate_files(*arguments, **options)
        return dataclasses.replace(found, estimate=dataclasses.replace(found.estimate, verdict=Verdict.DO_NOT_TRUST))

    monkeypatch.setattr(run, "estimate_files", doubtful)
    return image


def scene_state():
    """What others see of the scene: names of data, color spaces, compositors."""
    return (
        {image.name: (image.colorspace_settings.name, image.source, image.filepath) for image in bpy.data.images},
        [clip.name for clip in bpy.data.movieclips],
        [group.name for group in bpy.data.node_groups],
        bpy.context.scene.compositing_node_group if IS_BLENDER_5 else bpy.context.scene.use_nodes,
    )


def test_estimate_only_comes_first_and_changes_nothing_but_the_estimate(addon, image):
    assert addon.apply_as == image.camera_response_settings.apply == "NODES"
    before = scene_state()
    assert bpy.ops.crf.estimate_response(image=image.name) == {"FINISHED"}
    assert scene_state() == before
    assert "camera_response" in image
    assert bpy.ops.crf.apply_response(image=image.name) == {"FINISHED"}
    assert scene_state() != before


@pytest.mark.parametrize("mode", ["NODES", "BAKE", "EXPORT"])
def test_do_not_trust_is_not_applied_without_the_users_word(untrusted, tmp_path, mode):
    folder = tmp_path / "out"
    before = scene_state()
    choices = {"image": untrusted.name, "apply": mode, "folder": str(folder)}
    for operator in (bpy.ops.crf.estimate_response, bpy.ops.crf.apply_response):
        with pytest.raises(RuntimeError, match=r"not to be trusted; .* press Apply Anyway \(anyway=True\)"):
            operator(**choices)
        assert scene_state() == before
        assert not folder.exists()
        assert (untrusted.camera_response.verdict, untrusted.camera_response.is_applied) == ("do not trust", False)
    assert bpy.ops.crf.apply_response(**choices, anyway=True) == {"FINISHED"}
    assert folder.exists() or scene_state() != before


def test_there_is_no_redo_panel_and_no_choice_is_left_for_the_next_plate(image, plate_file, codes, tmp_path):
    """The panel would show the arguments of the call, not what was done, and do something else at a change."""
    other = load(write_image(plate_file.with_name("other.png"), codes))
    choices = {"apply": "EXPORT", "folder": str(tmp_path / "out"), "overwrite": True, "exposure": 1}
    for operator in (bpy.ops.crf.estimate_response, bpy.ops.crf.apply_response):
        operator("EXEC_DEFAULT", True, image=image.name, **choices)
        assert bpy.context.active_operator is None
    bpy.ops.crf.estimate_response("EXEC_DEFAULT", True, image=other.name)
    assert (other.camera_response_settings.apply, other.camera_response_settings.exposure) == ("NODES", 0)


def test_the_estimate_is_kept_if_it_cannot_be_applied(image, tmp_path, monkeypatch):
    from blender_addon.work import writers
    from crfnet.errors import PlateError

    def refuse(*_arguments, **_options):
        raise PlateError("the disk is full, color and all")

    monkeypatch.setattr(writers, "write", refuse)
    before = scene_state()
    with pytest.raises(RuntimeError, match="the disk is full, color and all"):
        bpy.ops.crf.estimate_response(image=image.name, apply="EXPORT", folder=str(tmp_path / "out"))
    assert "camera_response" in image
    assert scene_state() == before
    monkeypatch.undo()
    apply(image, "EXPORT", folder=str(tmp_path / "out"))


def test_a_packed_image_goes_beside_a_saved_blend(image, plate_file, tmp_path):
    image.pack()
    plate_file.unlink()
    (tmp_path / "project").mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "project" / "shot.blend"))
    estimate(image, "BAKE")
    assert (tmp_path / "project" / "plate_linear.exr").is_file()
