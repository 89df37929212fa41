"""The RGB Curves nodes of the node group: how exact they are, and what they make of values that are no codes."""

import numpy as np
import pytest

from tests.helpers.images import write_image

from .helpers import bpy, load

#: Codes from here on of 8 bits, of 10 bits the same brightnesses; and the largest error, in stops.
FIRST, STOPS = 8, 1e-3


@pytest.fixture
def decoded(addon, tree, composited, tmp_path):
    """What the node group of a curve makes of brightnesses."""
    from blender_addon.scene.nodes import plate_group

    plates = {bits: load(write_image(tmp_path / f"{bits}.png", np.zeros((8, 8, 3), f"uint{bits}"))) for bits in (8, 16)}
    source = tree.nodes.new("CompositorNodeImage")
    node = tree.nodes.new("CompositorNodeGroup")

    def run(curve, brightness, bits=8):
        node.node_tree = plate_group.build_group(plates[bits], "plate", curve, 0)
        pixels = np.tile(np.asarray(brightness, np.float32)[:, None], (8, 1, 3))
        if source.image:
            bpy.data.images.remove(source.image)
        source.image = load(write_image(tmp_path / "brightness.exr", pixels))
        source.image.colorspace_settings.name = "Non-Color"
        tree.links.new(source.outputs["Image"], node.inputs["Image"])
        return composited(node.outputs[0], size=(len(brightness), 8))[0, :, 0]

    return run


def cameras():
    from crfnet_core.library.camera import read_camera
    from crfnet_core.library.library import SHIPPED

    return [read_camera(path).curve for path in sorted(SHIPPED.glob("*.json"))]


def bank(chosen=slice(None, None, 11)):
    from crfnet_core import ResponseCurve
    from crfnet_core.posterior.responses import ResponseBank

    return [ResponseCurve.restored(samples) for samples in ResponseBank.load().brightness[chosen]]


def steep():
    """Responses so flat near white that the light at codes of 12 bits lies apart from the nearest of 16."""
    return bank([1325, 1330, 1758])


@pytest.mark.parametrize(("curves", "largest"), [(cameras, 255), (bank, 255), (cameras, 1023), (steep, 4095)])
def test_the_light_of_all_codes_above_7(decoded, curves, largest):
    brightness = np.arange(-(-FIRST * largest // 255), largest + 1) / largest
    bits = 8 if largest == 255 else 16
    errors = [np.abs(np.log2(decoded(curve, brightness, bits) / curve.inverse(brightness))).max() for curve in curves()]
    assert max(errors) < STOPS


def test_it_clips_as_a_bake_does(decoded):
    from crfnet_core import ResponseCurve

    light = decoded(ResponseCurve.gamma(), [-0.5, -0.001, 0, 1, 1.001, 1.5])
    assert light == pytest.approx([0, 0, 0, 1, 1, 1], abs=1e-5)
