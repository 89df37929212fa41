"""Every plate has its own response, nothing is linearized twice, and nothing that others see changes."""

import numpy as np
import pytest

from tests.helpers.images import write_image

from .helpers import bpy, groups, load, load_sequence, reopen
from .helpers import estimate as run

CODES = 1e-5

#: The same on deeper ones: 3e-4 stop.
DEEP = 2e-4


@pytest.fixture
def tree(tree):
    """The scene's compositor tree, with nothing in it but an output."""
    for node in [node for node in tree.nodes if node.type not in ("GROUP_OUTPUT", "COMPOSITE")]:
        tree.nodes.remove(node)
    return tree


@pytest.fixture
def twins(addon, tmp_path, codes):
    """Two photographs of one file name in two folders."""
    found = []
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        found.append(load(write_image(tmp_path / folder / "IMG_0001.png", codes)))
    return found


def add_node(tree, image):
    node = tree.nodes.new("CompositorNodeImage")
    node.image = image
    return node


def group_with(tree, image):
    """The group node whose Image input comes straight from a node that shows the plate's files."""
    for node in groups(tree):
        source = node.inputs["Image"].links[0].from_node
        if source.image.filepath == image.filepath:
            return node
    raise AssertionError(f"no group for {image.name}")


class TestTwoPlatesOfOneName:
    def test_they_have_two_groups_and_two_luts(self, twins, tree, composited, codes, monkeypatch):
        from blender_addon.scene.nodes import plate_group
        from crfnet_core import ResponseCurve

        curves = {image: ResponseCurve.gamma(gamma) for image, gamma in zip(twins, (2.6, 1.8), strict=True)}
        build = plate_group.build_group
        monkeypatch.setattr(
            plate_group,
            "build_group",
            lambda plate, name, _, *args, **kind: build(plate, name, curves[plate], *args, **kind),
        )
        for image in twins:
            run(image, "NODES")
        found = [group_with(tree, image) for image in twins]
        assert len({node.node_tree.name for node in found}) == 2
        for image, node in zip(twins, found, strict=True):
            expected = curves[image].inverse(codes / 255)
            assert np.abs(composited(node.outputs[0])[..., :3] - expected).max() < CODES

    def test_they_stay_apart_after_renaming_saving_and_appending(self, twins, tree, tmp_path):
        for image in twins:
            run(image, "NODES")
        names = {group_with(tree, image).node_tree.name for image in twins}
        twins[1].name = "renamed"
        saved = str(tmp_path / "shot.blend")
        reopen(saved)
        before = {group.name for group in bpy.data.node_groups}
        run(bpy.data.images["renamed"], "NODES", exposure=1)
        assert {group.name for group in bpy.data.node_groups} == before
        bpy.ops.wm.read_factory_settings(use_empty=True)
        with bpy.data.libraries.load(saved) as (source, target):
            target.node_groups = [name for name in source.node_groups if name in names]
        plates = {group["camera_response_of"].filepath for group in target.node_groups}
        assert len(plates) == 2


def test_an_exported_config_knows_no_frame_by_its_number_alone(addon, tmp_path, codes):
    """Frames that are named by numbers alone would make every such file of the machine a plate."""
    import PyOpenColorIO as OCIO

    paths = [write_image(tmp_path / f"{number:04d}.png", codes) for number in range(1, 4)]
    run(load_sequence(paths[0]), "EXPORT", folder=str(tmp_path / "config"))
    config = OCIO.Config.CreateFromFile(str(tmp_path / "config" / "config.ocio"))
    for path in ("/elsewhere/holiday.png", "/elsewhere/0001.png", str(paths[0])):
        assert not config.getColorSpaceFromFilepath(path)[0].startswith("CRF")


class TestNothingIsLinearizedTwice:
    @pytest.mark.parametrize(
        "between",
        [
            ["NodeReroute"],
            ["NodeReroute", "NodeReroute"],
            ["CompositorNodeScale"],
            ["CompositorNodeDenoise", "NodeReroute", "CompositorNodeBlur"],
        ],
        ids="-".join,
    )
    def test_whatever_stands_between(self, image, tree, between):
        source = add_node(tree, image)
        run(image, "NODES")
        (group,) = groups(tree)
        socket = source.outputs["Image"]
        for kind in between:
            node = tree.nodes.new(kind)
            tree.links.new(socket, node.inputs["Image"] if "Image" in node.inputs else node.inputs[0])
            socket = node.outputs[0]
        tree.links.new(socket, group.inputs["Image"])
        run(image, "NODES", exposure=1)
        assert groups(tree) == [group]
        assert group.inputs["Exposure"].default_value == 1

    @pytest.mark.parametrize("is_outside", [True, False])
    def test_in_or_behind_a_group_of_the_user(self, image, tree, is_outside):
        """Either the response's group is in the user's, or the plate's node is."""
        run(image, "NODES")
        (group,) = groups(tree)
        source = group.inputs["Image"].links[0].from_node
        mine = bpy.data.node_groups.new("Mine", "CompositorNodeTree")
        mine.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        mine.interface.new_socket("Image", in_out="INPUT", socket_type="NodeSocketColor")
        start, end = mine.nodes.new("NodeGroupInput"), mine.nodes.new("NodeGroupOutput")
        holder = tree.nodes.new("CompositorNodeGroup")
        holder.node_tree = mine
        if is_outside:  # the plate's node is in the user's group
            inner = add_node(mine, source.image)
            mine.links.new(inner.outputs["Image"], end.inputs[0])
            tree.links.new(holder.outputs[0], group.inputs["Image"])
            tree.nodes.remove(source)
            edited, expected = mine, 0
        else:
            inner = mine.nodes.new("CompositorNodeGroup")
            inner.node_tree = group.node_tree
            mine.links.new(start.outputs[0], inner.inputs["Image"])
            mine.links.new(inner.outputs[0], end.inputs[0])
            tree.links.new(source.outputs["Image"], holder.inputs[0])
            tree.nodes.remove(group)
            edited, expected = tree, 1  # the user's own
        from blender_addon.scene.nodes import compositor

        wanted = compositor.PlateNodes(
            plate=image,
            codes=next(each for each in bpy.data.images if "code values" in each.name),
            group=next(each for each in bpy.data.node_groups if "Response" in each.name),
            exposure=1,
        )
        compositor.apply_group(bpy.context.scene, edited, wanted)
        assert len(groups(edited)) == expected


class TestTheRestStaysAsItIs:
    @pytest.mark.parametrize("space", ["AgX Base sRGB", "Display P3", "Rec.2020"])
    @pytest.mark.parametrize("depth", ["uint8", "uint16"])
    def test_in_every_color_space(self, addon, tree, tmp_path, composited, codes, estimate, space, depth):
        """Some limit their values, so that what an Image node delivers could not be undone."""
        path = write_image(tmp_path / "plate.png", codes.astype(depth) * (257 if depth == "uint16" else 1))
        image = load(path)
        image.colorspace_settings.name = space
        run(image, "NODES", exposure=1.5)
        expected = estimate(path).curve.inverse(codes / 255) * 2**1.5
        limit = (CODES if depth == "uint8" else DEEP) * 2**1.5
        assert np.abs(composited(groups(tree)[0].outputs[0])[..., :3] - expected).max() < limit
        assert image.colorspace_settings.name == space
        assert not image.is_dirty

    def test_the_copy_stands_behind_its_plate(self, image, tree):
        """And does not outlive its user."""
        users = image.users
        run(image, "NODES")
        assert image.users > users  # its copy and its group know it
        assert not image.is_dirty
        others = [other for other in bpy.data.images if other != image and other.type == "IMAGE"]
        assert len(others) == 1
        assert others[0].name.startswith("plate.png code values ")
        assert not any(datablock.use_fake_user for datablock in (*others, *bpy.data.node_groups))
