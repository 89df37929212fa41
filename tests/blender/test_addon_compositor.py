"""The compositor's tree after a plate is applied: one viewer, room for the new node, the selection, the timing."""

import pytest

from tests.helpers.images import write_image

from .helpers import IS_BLENDER_5, bpy, estimate, groups, load, load_sequence, words_in


@pytest.fixture
def tree(tree):
    tree.nodes.clear()
    return tree


@pytest.fixture
def plates(tmp_path, codes, addon):
    return [load(write_image(tmp_path / f"{name}.png", codes)) for name in ("one", "two")]


@pytest.fixture
def sequence(tmp_path, codes, addon):
    paths = [write_image(tmp_path / f"shot.{number}.png", codes) for number in (1001, 1002, 1003)]
    return load_sequence(paths[0])


def of_kind(tree, kind):
    return [node for node in tree.nodes if node.type == kind]


def timing(user):
    return user.frame_duration, user.frame_start, user.frame_offset


def test_a_viewer_that_shows_something_else_keeps_it(tree, plates):
    render, viewer = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("CompositorNodeViewer")
    tree.links.new(render.outputs["Image"], viewer.inputs["Image"])
    estimate(plates[0], "NODES")
    assert viewer.inputs["Image"].links[0].from_node == render
    (other,) = (node for node in of_kind(tree, "VIEWER") if node != viewer)
    assert other.inputs["Image"].links[0].from_node.type == "GROUP"


@pytest.mark.skipif(IS_BLENDER_5, reason="later, a compositor cannot be switched off so")
def test_a_compositor_that_is_switched_off_stays_off_and_report_and_panel_say_so(tree, plates, in_editor, capfd):
    bpy.context.scene.use_nodes = False
    estimate(plates[0], "NODES")
    assert not bpy.context.scene.use_nodes
    assert "switched off: tick Use Nodes" in capfd.readouterr().out
    assert "switched off: tick Use Nodes" in words_in(plates[0], in_editor)


@pytest.mark.skipif(not IS_BLENDER_5, reason="before, the compositor belongs to the scene")
def test_a_linked_compositor_is_refused_and_nothing_is_stored(tree, plates, tmp_path):
    library = str(tmp_path / "library.blend")
    bpy.data.libraries.write(library, {tree})
    with bpy.data.libraries.load(library, link=True) as (_, here):
        here.node_groups = [tree.name]
    bpy.context.scene.compositing_node_group = here.node_groups[0]
    with pytest.raises(RuntimeError, match="linked from another file: make it local first"):
        estimate(plates[0], "NODES")
    assert "camera_response" not in plates[0]


def test_a_new_group_is_the_only_selected_node_and_one_brought_up_to_date_leaves_the_selection(tree, plates):
    for image in plates:
        estimate(image, "NODES")
        selected = [node for node in tree.nodes if node.select]
        assert selected == [tree.nodes.active]
        assert selected[0].node_tree["camera_response_of"] == image
        (viewer,) = of_kind(tree, "VIEWER")  # one, which shows the last plate
        assert viewer.inputs["Image"].links[0].from_node == selected[0]
    tree.nodes.active = viewer
    for node in tree.nodes:
        node.select = node == viewer
    estimate(plates[0], "NODES", exposure=1)
    assert tree.nodes.active == viewer
    assert [node for node in tree.nodes if node.select] == [viewer]


@pytest.mark.parametrize("in_frame", [False, True])
def test_the_nodes_behind_make_room(tree, plates, in_frame):
    source, blur, view = (tree.nodes.new(f"CompositorNode{kind}") for kind in ("Image", "Blur", "Viewer"))
    source.image = plates[0]
    other = tree.nodes.new("CompositorNodeBlur")
    other.location = (200, -400)
    blur.location, view.location = (200, 0), (400, 0)
    tree.links.new(source.outputs["Image"], blur.inputs["Image"])
    tree.links.new(blur.outputs["Image"], view.inputs["Image"])
    if in_frame:
        frame = tree.nodes.new("NodeFrame")
        frame.location = (50, 50)
        blur.parent = frame
    distance = view.location_absolute.x - blur.location_absolute.x
    estimate(plates[0], "NODES")
    (group,) = groups(tree)
    assert group.location_absolute.x >= source.location_absolute.x + source.width
    assert blur.location_absolute.x >= group.location_absolute.x + group.width
    assert view.location_absolute.x - blur.location_absolute.x == pytest.approx(distance)
    assert tuple(other.location) == (200, -400)


@pytest.mark.parametrize("mode", ["NODES", "BAKE"])
@pytest.mark.parametrize(("before", "after"), [((3, 1, 1000), (3, 1, 1000)), ((100, 1, 0), (3, 1001, 1000))])
def test_the_timing_of_the_editor_goes_on_if_it_shows_a_file(tree, sequence, in_editor, mode, before, after):
    """Blender opens it with 3, 1, 1000; an editor begins with the frames 1 to 100, of which this sequence has none."""
    with in_editor("IMAGE_EDITOR") as space:
        space.image = sequence
        user = space.image_user
        user.frame_duration, user.frame_start, user.frame_offset = before
        assert bpy.ops.crf.estimate_response(apply=mode) == {"FINISHED"}
        shown = space.image_user if mode == "BAKE" else of_kind(tree, "IMAGE")[0]
        assert timing(shown) == after
        assert (space.image.name == "shot_linear.1001.exr") == (mode == "BAKE")


def test_a_node_keeps_its_timing(tree, sequence):
    node = tree.nodes.new("CompositorNodeImage")
    node.image = sequence
    node.frame_duration, node.frame_start, node.frame_offset, node.use_cyclic = 3, 11, 1000, True
    estimate(sequence, "NODES")
    assert timing(node) == (3, 11, 1000)
    assert node.use_cyclic
    assert node.image != sequence


def test_the_baked_clip_has_timing_tracks_and_camera(sequence):
    clip = bpy.data.movieclips.load(sequence.filepath)
    clip.frame_start, clip.frame_offset = 101, 3
    clip.tracking.camera.focal_length = 77
    track = clip.tracking.tracks.new(name="corner", frame=1)
    track.markers.insert_frame(2, co=(0.25, 0.5))
    estimate(clip, "BAKE")
    baked = bpy.data.movieclips["shot_linear.1001.exr"]
    assert (baked.frame_start, baked.frame_offset) == (101, 3)
    assert baked.tracking.camera.focal_length == 77
    assert [track.name for track in baked.tracking.tracks] == ["corner"]
    assert tuple(baked.tracking.tracks[0].markers.find_frame(2).co) == (0.25, 0.5)
    assert (baked.source, baked.colorspace_settings.name) == ("SEQUENCE", "Linear Rec.709")
    assert "camera_response" not in baked
    with pytest.raises(RuntimeError, match="linear already"):
        bpy.ops.crf.estimate_response(clip=baked.name)
    baked.tracking.camera.focal_length = 50
    bpy.ops.crf.apply_response(clip=clip.name, apply="BAKE", overwrite=True)
    assert [clip.name for clip in bpy.data.movieclips if "linear" in clip.name] == ["shot_linear.1001.exr"]
    assert baked.tracking.camera.focal_length == 50


@pytest.mark.parametrize("kind", ["image", "clip"])
@pytest.mark.parametrize("is_relative", [True, False])
def test_a_relative_path_stays_relative(addon, tmp_path, codes, kind, is_relative):
    path = write_image(tmp_path / "plate.png", codes)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    datablock = load(path, kind)
    datablock.filepath = "//plate.png" if is_relative else str(path)
    estimate(datablock, "BAKE")
    found = (bpy.data.images if kind == "image" else bpy.data.movieclips)["plate_linear.exr"].filepath
    assert found == ("//plate_linear.exr" if is_relative else str(tmp_path / "plate_linear.exr"))


@pytest.mark.parametrize("is_packed", [False, True])
def test_unsaved_painting_is_not_lost(addon, tree, tmp_path, codes, is_packed):
    image = load(write_image(tmp_path / "plate.png", codes))
    if is_packed:
        image.pack()
    image.pixels[0] = 0.25
    for mode in ("NODES", "BAKE", "EXPORT"):
        with pytest.raises(RuntimeError, match="has unsaved changes"):
            estimate(image, mode)
    assert image.is_dirty
    assert image.pixels[0] == pytest.approx(0.25, abs=1 / 255)
    if is_packed:
        image.pack()
    else:
        image.save()
    estimate(image, "NODES")
