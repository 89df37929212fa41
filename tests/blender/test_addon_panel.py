"""What the panel shows: settings, words and the icon of the response."""

import pytest

from .helpers import apply, bpy, drawn_here, drawn_in, estimate, labels, operators, words_in

pytestmark = pytest.mark.usefixtures("estimated")


#: The ways to apply a response.
MODES = ["NODES", "BAKE", "EXPORT"]


@pytest.mark.parametrize("mode", MODES)
def test_it_draws_every_mode(image, in_editor, mode):
    """Apply comes right behind the verdict, the curve and the ways to apply it; no word stands between."""
    image.camera_response_settings.apply = mode
    drawn = drawn_in(image, in_editor)
    properties = [entry[2] for entry in drawn if entry[0] == "prop"]
    apply = drawn.index(("operator", "crf.apply_response", "Apply", "CHECKMARK"))
    curve = next(n for n, entry in enumerate(drawn) if entry[0] == "template_icon")
    assert [entry[2:] for entry in drawn if entry[0] == "prop_enum"] == [("apply", mode) for mode in MODES]
    assert not [entry for entry in drawn[:apply] if entry[0] == "prop"]
    assert not labels(drawn[curve:apply])
    assert ("compose" in properties) == (mode == "NODES")
    words = " ".join(labels(drawn))
    parts = ("analyzed windows agree", "Expected error 0.", "Dashed: gamma 2.2", "Most likely")
    assert all(part in words for part in parts)
    assert "E_est" not in words
    assert "The estimate is" not in words  # the verdict says it
    assert "ignore_metadata" in properties
    assert ("overwrite" in properties) == (mode in ("BAKE", "EXPORT"))
    folders = [entry[3] for entry in drawn if entry[0] == "prop" and entry[2] == "folder"]
    assert folders == ["Folder of the plate"] * (mode in ("BAKE", "EXPORT"))


@pytest.mark.parametrize(
    ("verdict", "word", "icon"), [("usable", "Usable", "INFO"), ("do not trust", "Do not trust", "ERROR")]
)
def test_the_verdict_comes_first_in_a_word_with_an_icon(image, in_editor, verdict, word, icon):
    image["camera_response"]["verdict"] = verdict
    image["camera_response"]["notices"] = "[]"
    image["camera_response"]["advice"] = "Take another." if verdict == "do not trust" else ""
    image.camera_response_settings.apply = "NODES"
    drawn = drawn_in(image, in_editor)
    assert next(entry for entry in drawn if entry[0] == "label") == ("label", word, icon)
    button = "Apply Anyway" if verdict == "do not trust" else "Apply"
    assert [text for name, text in operators(drawn) if name == "crf.apply_response"] == [button]
    words, is_doubted = " ".join(labels(drawn)), verdict == "do not trust"
    assert ("Take another." in words) == is_doubted
    assert ("Expected error 0." in words) == (not is_doubted)  # it would reassure
    assert ("Look at the linear plate before you rely on it." in words) == (not is_doubted)
    assert [entry[2] for entry in drawn if entry[:2] == ("set", "alert")] == [is_doubted]  # and never of the button


def test_every_line_fits_the_sidebar(image, in_editor):
    """20 letters, with an icon 17, is the least; only the verdict and buttons are longer words of their own."""
    image["camera_response"]["warnings"] = (
        "This photograph is gray, so the edges say nothing of range=limited:out=full."
    )
    drawn = drawn_in(image, in_editor)
    for entry in drawn:
        if entry[0] == "label" and len(entry) > 2:
            assert len(entry[1]) <= (20 if entry[2] == "NONE" else 17), entry
    assert "This photograph is gray, so the edges say nothing" in " ".join(labels(drawn))
    assert any(line.endswith("range=limited:") for line in labels(drawn))  # a long option is broken behind a colon


def test_a_narrow_range_is_no_more_than_the_mean_of_cameras(image, in_editor):
    image["camera_response"]["notices"] = '[["narrow_range", {}]]'
    for verdict in ("usable", "do not trust"):
        image["camera_response"]["verdict"] = verdict
        first, *others = labels(drawn_in(image, in_editor))
        assert first == ("Do not trust" if verdict == "do not trust" else "Mean of cameras")
        assert "Look at the linear plate" not in " ".join(others)


def test_settings_that_wait_to_be_applied_are_told(image, in_editor):
    assert shown(image, in_editor) == ("Apply", False, False)
    apply(image)
    assert shown(image, in_editor) == ("Apply Again", True, False)
    image.camera_response_settings.anchor = "GRAY"
    assert shown(image, in_editor) == ("Apply", False, True)
    image.camera_response_settings.anchor = "WHITE"
    assert shown(image, in_editor) == ("Apply Again", True, False)
    estimate(image)  # another response, which is not applied
    assert shown(image, in_editor) == ("Apply", False, False)
    assert "Its nodes keep the earlier response until you apply this one." in words_in(image, in_editor)


def shown(image, in_editor):
    """The button, and whether the settings are said to be applied, or to wait for it."""
    drawn = drawn_in(image, in_editor)
    (button,) = (text for name, text in operators(drawn) if name == "crf.apply_response")
    words = " ".join(labels(drawn))
    return button, "Applied with these settings." in words, "Changed settings count" in words


@pytest.mark.parametrize("missing", ["", "onnxruntime is missing: install the add-on again"])
@pytest.mark.parametrize("editor", ["IMAGE_EDITOR", "CLIP_EDITOR", "NODE_EDITOR"])
def test_it_names_a_missing_library_or_says_what_to_do_without_a_plate(addon, in_editor, monkeypatch, editor, missing):
    from blender_addon import lazy_import
    from blender_addon.scene.plates import OPEN_A_PLATE
    from blender_addon.ui.panel import ResponsePanel

    monkeypatch.setattr(lazy_import, "missing", lambda: missing)
    with in_editor(editor):
        assert ResponsePanel.poll(bpy.context)
        drawn = drawn_here()
        assert not bpy.ops.crf.estimate_response.poll()
    assert " ".join(labels(drawn)) == (missing or OPEN_A_PLATE[editor])
    assert operators(drawn) == []


def test_the_way_that_was_chosen_last_holds_for_other_plates(addon, image, tmp_path):
    other = bpy.data.images.new("new", 8, 8).camera_response_settings
    apply(image, "EXPORT", folder=str(tmp_path))  # a script's argument is no choice
    assert other.apply == addon.apply_as == "NODES"
    image.camera_response_settings.apply = "BAKE"
    assert other.apply == addon.apply_as == "BAKE"
    other.apply = "EXPORT"
    assert image.camera_response_settings.apply == "BAKE"


def test_the_interface_offers_what_jobs_and_ocio_know(addon):
    """It repeats their choices and defaults, because it is drawn without them."""
    from blender_addon.scene.color_management import CONFIG_NAME
    from blender_addon.work.job import Anchor, ApplyMode
    from crfnet import defaults

    settings = bpy.data.images.new("new", 8, 8).camera_response_settings.bl_rna.properties
    assert ["ESTIMATE", *settings["apply"].enum_items.keys()] == list(ApplyMode)
    assert settings["anchor"].enum_items.keys() == list(Anchor)
    assert settings["depth"].enum_items.keys() == list(defaults.DEPTHS)
    assert settings["prior"].enum_items.keys() == list(defaults.PRIORS)
    assert settings["prior"].default == defaults.PRIORS[0]
    assert settings["device"].enum_items.keys() == ["file", *defaults.DEVICES]
    assert -settings["exposure"].hard_min == settings["exposure"].hard_max == defaults.MAX_EXPOSURE
    assert defaults.CONFIG_NAME == CONFIG_NAME
