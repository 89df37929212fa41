"""What is in the user's config: told until Blender is restarted, listed, and taken out again."""

import hashlib
import json
from types import SimpleNamespace

import pytest

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")

from .test_addon_panel import Panel, drawn_in, labels  # noqa: E402 - after the skip


@pytest.fixture
def image(addon, plate_file):
    return bpy.data.images.load(str(plate_file))


@pytest.fixture
def user_config(image):
    """The user's config with the plate's colour space; it is removed at the end."""
    from blender_addon.scene.color_management import user_folder

    assert bpy.ops.crf.estimate_response(image=image.name, apply="COLORSPACE") == {"FINISHED"}
    yield user_folder() / "config.ocio"
    if (user_folder() / "camera_response" / "installed.json").exists():
        bpy.ops.crf.restore_config()


def preferences_drawn(addon):
    from blender_addon.ui.preferences import CRF_AddonPreferences

    panel = Panel()
    CRF_AddonPreferences.draw(SimpleNamespace(layout=panel.layout), bpy.context)
    return panel.layout.drawn


def test_a_restart_is_due_until_it_is_done(image, user_config, in_editor, monkeypatch):
    from blender_addon.ui import config_operators

    for _ in range(2):  # and not only once
        drawn = drawn_in(image, in_editor)
        buttons = [entry[1] for entry in drawn if entry[0] == "operator"]
        assert "wm.save_as_mainfile" in buttons  # the file has no name
        assert "crf.save_and_restart" not in buttons
        assert 'Restart due for "CRF plate". Save the file first' in " ".join(labels(drawn))
        assert "comes with a restart" not in " ".join(labels(drawn))
    with monkeypatch.context() as restarted:  # what the next Blender reads at its start
        restarted.setattr(config_operators, "_read_at_start", config_operators._fingerprint())
        drawn = drawn_in(image, in_editor)
        assert "crf.save_and_restart" not in [entry[1] for entry in drawn if entry[0] == "operator"]
        bpy.ops.crf.apply_response(image=image.name)  # the same again changes nothing
        assert not config_operators.is_restart_due()
        bpy.ops.crf.apply_response(image=image.name, exposure=1)
        assert config_operators.is_restart_due()
        bpy.ops.crf.restore_config()
        assert config_operators.is_restart_due()  # the config that Blender runs on is gone


def test_a_config_of_an_earlier_blender_is_told_and_restored(image, user_config, in_editor, monkeypatch):
    """Load Previous Settings brings the earlier version's config along."""
    from blender_addon.ui import config_operators

    text = user_config.read_text()
    name = "AgX Log"
    before, after = text.split(f"    name: {name}\n")
    user_config.write_text(f"{before}    name: of an earlier Blender\n{after}")
    _take_for_ours(user_config)
    monkeypatch.setattr(config_operators, "_read_at_start", config_operators._fingerprint())
    drawn = drawn_in(image, in_editor)
    assert f"which lacks 1 of its color spaces, such as {name}." in " ".join(labels(drawn))
    assert "crf.restore_config" in [entry[1] for entry in drawn if entry[0] == "operator"]
    assert bpy.ops.crf.restore_config() == {"FINISHED"}
    assert "earlier version" not in " ".join(labels(drawn_in(image, in_editor)))


def _take_for_ours(config):
    """Let the record say that the config is as the add-on has written it."""
    record = config.parent / "camera_response" / "installed.json"
    entries = json.loads(record.read_text())
    record.write_text(json.dumps(entries | {"sha256": hashlib.sha256(config.read_bytes()).hexdigest()}))


def test_the_panel_restarts_a_file_that_has_a_name(image, user_config, in_editor, tmp_path):
    image.use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    drawn = drawn_in(image, in_editor)
    buttons = [entry[1] for entry in drawn if entry[0] == "operator"]
    assert "crf.save_and_restart" in buttons
    assert "wm.save_as_mainfile" not in buttons
    assert "Save the file first" not in " ".join(labels(drawn))


def test_the_report_and_the_panel_say_the_same(image, user_config, capfd):
    bpy.ops.crf.apply_response(image=image.name, apply="COLORSPACE", exposure=1)
    assert 'restart due for "CRF plate": press Save and Restart' in capfd.readouterr().out


def test_another_estimate_does_not_end_the_wait(image, user_config):
    from blender_addon.scene.stored_estimate import pending_color_space

    bpy.ops.crf.estimate_response(image=image.name, apply="ESTIMATE")
    assert pending_color_space(image) == "CRF plate"


def test_a_restored_config_leaves_nothing_to_do(image, user_config):
    """Blender has never read the config that came and went."""
    from blender_addon.ui import config_operators

    assert config_operators.is_restart_due()
    bpy.ops.crf.restore_config()
    assert not config_operators.is_restart_due()


@pytest.mark.parametrize("is_all", [True, False])
def test_no_plate_waits_for_a_color_space_that_was_taken_out(image, user_config, in_editor, is_all):
    from blender_addon.scene.stored_estimate import pending_color_space

    assert "Applied with these settings." in " ".join(labels(drawn_in(image, in_editor)))
    if is_all:
        bpy.ops.crf.restore_config()
    else:
        bpy.ops.crf.remove_color_space(color_space="CRF plate")
    assert pending_color_space(image) == ""
    words = " ".join(labels(drawn_in(image, in_editor)))
    assert "CRF plate" not in words
    assert "Applied with these settings." not in words


def test_disabling_the_addon_does_not_make_a_restart_forgotten(user_config):
    import addon_utils

    from blender_addon.ui import config_operators

    addon_utils.disable("blender_addon")
    addon_utils.enable("blender_addon")
    assert config_operators.is_restart_due()


def test_the_preferences_list_what_is_installed_and_remove_it(addon, user_config, plate_file, codes):
    from tests.helpers.images import write_image

    other = bpy.data.images.load(str(write_image(plate_file.with_name("other.png"), codes)))
    bpy.ops.crf.estimate_response(image=other.name, apply="COLORSPACE")
    assert {"CRF plate", "CRF other"} <= set(labels(preferences_drawn(addon)))
    bpy.ops.crf.remove_color_space(color_space="CRF other")
    assert "CRF other" not in labels(preferences_drawn(addon))
    assert "CRF plate" in labels(preferences_drawn(addon))
    bpy.ops.crf.remove_color_space(color_space="CRF plate")
    drawn = preferences_drawn(addon)
    assert "CRF plate" not in labels(drawn)
    assert not [entry for entry in drawn if entry[0] == "operator" and "restore" in entry[1]]
    assert not user_config.exists()
    with pytest.raises(RuntimeError, match="no installed color space"):
        bpy.ops.crf.remove_color_space(color_space="CRF plate")


@pytest.fixture
def started(monkeypatch):
    """What would have been started, and whether this Blender would have quit."""
    from blender_addon.ui import config_operators

    calls = []
    monkeypatch.setattr(
        config_operators.subprocess, "Popen", lambda command, **options: calls.append((command, options["env"]))
    )
    quit_blender = SimpleNamespace(quit_blender=lambda: calls.append("quit"), save_mainfile=bpy.ops.wm.save_mainfile)
    operations = SimpleNamespace(wm=quit_blender, ed=bpy.ops.ed)
    monkeypatch.setattr(
        config_operators,
        "bpy",
        SimpleNamespace(ops=operations, data=bpy.data, app=bpy.app, types=bpy.types, utils=bpy.utils),
    )
    return calls


def test_save_and_restart(image, tmp_path, started, monkeypatch):
    """The new Blender has to look for the config itself: Blender 5.2 names the old one in the environment."""
    from blender_addon.scene import color_management

    assert not bpy.ops.crf.save_and_restart.poll()  # there is no file yet
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    monkeypatch.setenv("OCIO", color_management.running_config())
    image.use_fake_user = True
    before = (tmp_path / "shot.blend").read_bytes()
    assert bpy.ops.crf.save_and_restart() == {"FINISHED"}
    (command, environment), quit_blender = started
    assert command == [bpy.app.binary_path, str(tmp_path / "shot.blend")]
    assert "OCIO" not in environment
    assert quit_blender == "quit"
    assert (tmp_path / "shot.blend").read_bytes() != before


def test_a_config_that_the_environment_demands_stays_in_it(image, tmp_path, started, monkeypatch):
    monkeypatch.setenv("OCIO", str(tmp_path / "studio.ocio"))
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    bpy.ops.crf.save_and_restart()
    assert started[0][1]["OCIO"] == str(tmp_path / "studio.ocio")


def test_painted_images_are_not_lost(image, tmp_path, started):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    painted = bpy.data.images.new("painted", 8, 8)
    painted.pixels[0] = 0.5
    with pytest.raises(RuntimeError, match="painted: has changes that would be lost"):
        bpy.ops.crf.save_and_restart()
    assert started == []
    painted.pack()
    assert bpy.ops.crf.save_and_restart() == {"FINISHED"}


def test_nothing_is_quit_that_was_not_saved(image, tmp_path, started, monkeypatch):
    from blender_addon.ui import config_operators

    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))

    def refuse():
        raise RuntimeError("the disk is full")

    monkeypatch.setattr(config_operators.bpy.ops.wm, "save_mainfile", refuse)
    with pytest.raises(RuntimeError, match="Blender was not restarted: the disk is full"):
        bpy.ops.crf.save_and_restart()
    assert started == []
