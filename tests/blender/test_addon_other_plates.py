"""The response of one plate, applied to other plates of the same camera."""

import pytest

from tests.helpers.cameras import photograph
from tests.helpers.images import write_image

from .helpers import apply, bpy, drawn_in, estimate, groups, labels, load


@pytest.fixture
def images(addon, tmp_path, codes):
    """Three plates; the first one has an estimate."""
    paths = [write_image(tmp_path / f"{name}.png", codes) for name in ("one", "two", "three")]
    images = [load(path) for path in paths]
    bpy.ops.crf.estimate_response(image="one.png", exposure=1.5)
    return images


def copy(*names, is_clip=False, is_chosen=True):
    targets = [{"name": name, "is_clip": is_clip, "is_chosen": is_chosen} for name in names]
    return bpy.ops.crf.copy_response(image="one.png", targets=targets)


def test_each_gets_a_response_without_verdict_that_says_where_it_is_from(images, in_editor):
    one, two, three = images
    assert copy("two.png") == {"FINISHED"}
    stored = two["camera_response"]
    assert stored["brightness"].to_list() == one["camera_response"]["brightness"].to_list()
    assert (stored["origin"], stored["exposure"]) == ("From one.png", 1.5)
    assert "camera_response" not in three
    assert "origin" not in one["camera_response"]
    words = labels(drawn_in(two, in_editor))
    assert (words[0], "Usable" in words, "From one.png" in " ".join(words)) == ("Copied", False, True)
    apply(two)
    assert two.camera_response.origin == "From one.png"
    estimate(two)
    assert two.camera_response.origin == ""


def test_it_is_applied_as_to_the_first(images, tree):
    images[0].camera_response_settings.apply = "NODES"
    copy("two.png", "three.png")
    assert {node.node_tree["camera_response_of"] for node in groups(tree)} == set(images[1:])
    assert {node.inputs["Exposure"].default_value for node in groups(tree)} == {1.5}


def test_a_clip_gets_it_too(images, tmp_path):
    clip = load(tmp_path / "two.png", "clip")
    copy(clip.name, is_clip=True)
    assert clip["camera_response"]["origin"] == "From one.png"
    assert "camera_response" not in images[1]


def test_bakes_wait_for_their_own_apply(images, tmp_path):
    images[0].camera_response_settings.apply = "BAKE"
    copy("two.png")
    assert images[1].camera_response_settings.apply == "BAKE"
    assert not list(tmp_path.glob("*.exr"))
    bpy.ops.crf.apply_response(image="two.png")
    assert [path.name for path in tmp_path.glob("*.exr")] == ["two_linear.exr"]


def test_what_is_not_to_be_trusted_is_stored_only(images, tree):
    images[0]["camera_response"]["verdict"] = "do not trust"
    images[0].camera_response_settings.apply = "NODES"
    copy("two.png")
    assert images[1]["camera_response"]["origin"] == "From one.png"
    assert groups(tree) == []


def test_nothing_happens_if_one_plate_cannot_be_used(images):
    bpy.data.images.new("linear", 8, 8, float_buffer=True)
    with pytest.raises(RuntimeError, match="no camera response"):
        copy("two.png", "linear")
    assert "camera_response" not in images[1]
    with pytest.raises(RuntimeError, match="tick at least one"):
        copy("two.png", is_chosen=False)
    with pytest.raises(RuntimeError, match="tick at least one"):
        copy("one.png")


def test_a_plate_of_another_camera_is_named(addon, plate, tmp_path, capfd):
    from blender_addon.ui.more.other_plates import other_camera

    one, same, two = (
        load(photograph(plate, tmp_path / f"{name}.jpg", Make=make, Model="X"))
        for name, make in (("one", "Canon"), ("same", "Canon"), ("two", "NIKON"))
    )
    bpy.ops.crf.estimate_response(image=one.name)
    assert (other_camera(one, same), "NIKON" in other_camera(one, two)) == ("", True)
    targets = [{"name": two.name, "is_clip": False, "is_chosen": True}]
    bpy.ops.crf.copy_response(image=one.name, targets=targets)
    assert "two.jpg: its file names another camera, " in capfd.readouterr().out


def test_the_list_offers_other_plates_and_ticks_selected_nodes(images, tree, in_editor):
    from blender_addon.ui.more.other_plates import _selected, other_plates

    apply(images[0])  # makes hidden copies
    bpy.data.images.new("linear", 8, 8, float_buffer=True)
    assert set(other_plates(images[0])) == set(images[1:])
    node = tree.nodes.new("CompositorNodeImage")
    node.image = images[2]
    for other in tree.nodes:
        other.select = other == node
    with in_editor("NODE_EDITOR") as space:
        space.node_tree = tree
        assert _selected(bpy.context) == [images[2]]
    with in_editor("IMAGE_EDITOR"):
        assert _selected(bpy.context) == []
