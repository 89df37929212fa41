"""A plate in several places: nodes of one tree and of two scenes, each with the node group once."""

import pytest

from .helpers import apply, bpy, compositor_tree, groups, plates, words_in

pytestmark = pytest.mark.usefixtures("estimated")

APPLIED = "Applied with these settings."


def twice(image):
    from blender_addon.scene.nodes.links import linearized_twice

    return linearized_twice(image)


def test_two_nodes_of_a_tree_are_linearized_once_each(image, tree):
    for _ in range(2):
        tree.nodes.new("CompositorNodeImage").image = image
    apply(image)
    first, second = groups(tree)
    assert first.node_tree == second.node_tree
    assert twice(image) == ""
    tree.links.new(first.outputs[0], second.inputs["Image"])
    assert "two node groups follow" in twice(image)


def test_a_panel_reads_each_node_once_and_the_next_one_reads_it_again(image, tree, in_editor, monkeypatch):
    from blender_addon.scene.nodes import links

    apply(image)
    group, read = groups(tree)[0], []
    monkeypatch.setattr(links, "datablock_of_node", lambda node: read.append(node) or plates.datablock_of_node(node))
    for draws in (1, 2):
        words_in(image, in_editor)
        assert read.count(group) == draws


def exposures(scene):
    return [node.inputs["Exposure"].default_value for node in groups(compositor_tree(scene))]


@pytest.mark.parametrize("kind", ["NEW", "FULL_COPY"])
def test_two_scenes_are_linearized_once_each_and_keep_exposures_of_their_own(image, in_editor, kind):
    window = bpy.context.window_manager.windows[0]
    first = window.scene
    apply(image)
    bpy.ops.crf.add_look(image=image.name)
    with bpy.context.temp_override(window=window):
        bpy.ops.scene.new(type=kind)
    other = window.scene
    assert (APPLIED in words_in(image, in_editor)) == (kind == "FULL_COPY")
    apply(image, exposure=1)
    assert twice(image) == ""
    assert (exposures(first), exposures(other)) == ([0, 0], [1, 1] if kind == "FULL_COPY" else [1])  # with the look's
    assert APPLIED in words_in(image, in_editor)
    window.scene = first
    assert "The nodes of this scene have exposure 0.00 until you apply." in words_in(image, in_editor)


def test_nodes_that_hold_the_same_group_are_not_behind_each_other(addon, tree):
    """Nor are the nodes behind them; those that are linked inside and outside are."""
    from blender_addon.scene.nodes.links import nodes_behind

    mine = bpy.data.node_groups.new("Mine", "CompositorNodeTree")
    for in_out in ("INPUT", "OUTPUT"):
        mine.interface.new_socket("Image", in_out=in_out, socket_type="NodeSocketColor")
    start, blur, end = (mine.nodes.new(kind) for kind in ("NodeGroupInput", "CompositorNodeBlur", "NodeGroupOutput"))
    mine.links.new(start.outputs[0], blur.inputs["Image"])
    mine.links.new(blur.outputs[0], end.inputs[0])
    source = tree.nodes.new("CompositorNodeImage")
    holders = [tree.nodes.new("CompositorNodeGroup") for _ in range(2)]
    viewers = [tree.nodes.new("CompositorNodeViewer") for _ in range(2)]
    for holder, viewer in zip(holders, viewers, strict=True):
        holder.node_tree = mine
        tree.links.new(holder.outputs[0], viewer.inputs["Image"])
    tree.links.new(source.outputs["Image"], holders[0].inputs[0])
    assert set(nodes_behind(source)) == {holders[0], viewers[0], start, blur, end}
    assert set(nodes_behind(blur)) == {end, *holders, *viewers}  # from inside, it is every holder


def test_what_the_second_of_two_chained_nodes_holds_is_behind_what_the_first_holds(addon, tree):
    """Output A of the first is linked to input B of the second."""
    from blender_addon.scene.nodes.links import nodes_behind

    mine = bpy.data.node_groups.new("Mine", "CompositorNodeTree")
    for in_out in ("INPUT", "OUTPUT"):
        for name in "AB":
            mine.interface.new_socket(name, in_out=in_out, socket_type="NodeSocketColor")
    first, second = (tree.nodes.new("CompositorNodeGroup") for _ in range(2))
    first.node_tree = second.node_tree = mine
    tree.links.new(first.outputs["A"], second.inputs["B"])
    start, before, behind, end = (
        mine.nodes.new(kind)
        for kind in ("NodeGroupInput", "CompositorNodeBlur", "CompositorNodeBlur", "NodeGroupOutput")
    )
    mine.links.new(before.outputs[0], end.inputs["A"])
    mine.links.new(start.outputs["B"], behind.inputs["Image"])
    mine.links.new(behind.outputs[0], end.inputs["B"])
    assert set(nodes_behind(before)) == {end, first, second, start, behind}
    assert set(nodes_behind(behind)) == {end, first, second, start}
    tree.links.remove(second.inputs["B"].links[0])
    assert set(nodes_behind(before)) == {end, first, second}
