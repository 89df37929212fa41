"""Movies: the code values of the frame shown, estimates and errors."""

from itertools import pairwise

import numpy as np
import pytest

from tests.helpers.images import write_image

from .helpers import IS_BLENDER_5, bpy, curve_of, drawn_in, estimate, group_node, load, pixels_of, plates, show

FRAMES = 12

#: Container, codec and bits of the movies: RGB without loss, YUV of limited range without further loss, RGB of 10 bits.
CODECS = {"rgb.mkv": ("MKV", "FFV1", "8"), "yuv.mp4": ("MPEG4", "H264", "8"), "deep.mkv": ("MKV", "FFV1", "10")}


def frame_codes(codes, number):
    return np.roll(codes, 5 * number, axis=0)


@pytest.fixture(scope="module")
def movie_folder(tmp_path_factory):
    return tmp_path_factory.mktemp("movies")


@pytest.fixture
def movie(addon, movie_folder, codes):
    """Return the path of a movie of known code values, which Blender encodes once."""

    def encoded(name):
        path = movie_folder / name
        if not path.is_file():
            numbers = range(1, FRAMES + 1)
            encode(path, [write_image(movie_folder / f"{n:04d}.png", frame_codes(codes, n)) for n in numbers])
        return path

    return encoded


def encode(path, frames, color_mode="RGB"):
    """Encode 8-bit frames as they are."""
    container, codec, depth = CODECS[path.name]
    scene = bpy.data.scenes.new("Encoder")
    image = load(frames[0])
    image.source, image.colorspace_settings.name = "SEQUENCE", "Non-Color"
    tree, output = empty_tree(scene)
    node = tree.nodes.new("CompositorNodeImage")
    node.image = image
    node.frame_duration, node.frame_start, node.frame_offset = len(frames), 1, 0
    multiplied = tree.nodes.new("CompositorNodePremulKey")  # by alpha, which the encoder divides by
    if IS_BLENDER_5:
        multiplied.inputs["Type"].default_value = "To Premultiplied"
    else:
        multiplied.mapping = "STRAIGHT_TO_PREMUL"
    tree.links.new(node.outputs["Image"], multiplied.inputs["Image"])
    tree.links.new(multiplied.outputs["Image"], output.inputs[0])
    render, settings = scene.render, scene.render.image_settings
    render.resolution_x, render.resolution_y = 256, 256
    render.dither_intensity, render.compositor_device, render.compositor_precision = 0, "CPU", "FULL"
    scene.view_settings.view_transform = "Raw"
    scene.frame_end = len(frames)
    if hasattr(settings, "media_type"):
        settings.media_type = "VIDEO"
    settings.file_format = "FFMPEG"
    render.ffmpeg.format, render.ffmpeg.codec, render.ffmpeg.audio_codec = container, codec, "NONE"
    render.ffmpeg.constant_rate_factor = "LOSSLESS"
    settings.color_mode, settings.color_depth = color_mode, depth
    render.filepath, render.use_file_extension = str(path), False
    bpy.ops.render.render(animation=True, scene=scene.name)
    bpy.data.images.remove(image)
    bpy.data.scenes.remove(scene)


def empty_tree(scene):
    if IS_BLENDER_5:
        tree = scene.compositing_node_group = bpy.data.node_groups.new("Encoder", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        return tree, tree.nodes.new("NodeGroupOutput")
    scene.use_nodes = True
    scene.node_tree.nodes.clear()
    return scene.node_tree, scene.node_tree.nodes.new("CompositorNodeComposite")


@pytest.mark.parametrize("kind", ["image", "clip"])
@pytest.mark.parametrize("number", [1, 7, 12])
def test_a_plate_holds_the_code_values_of_the_frame_shown(movie, codes, kind, number):
    bpy.context.scene.frame_set(number)
    images = list(bpy.data.images)
    for name, most in (("rgb.mkv", 1), ("yuv.mp4", 2)):  # H.264 keeps 219 levels of brightness
        plate = plates.plate_of(load(movie(name), kind))
        assert (plate.shown_frame, plate.frame_count) == (number, FRAMES)
        difference = plate.content.astype(int) - frame_codes(codes, number)
        assert np.abs(difference).max() <= most
        assert abs(difference.mean()) < 0.1
    assert [image for image in bpy.data.images if image not in images and kind == "clip"] == []


def test_bake_is_gray_and_not_the_choice_for_a_movie(movie, addon, in_editor):
    image = load(movie("rgb.mkv"))
    estimate(image)
    addon.apply_as = "BAKE"
    assert image.camera_response_settings.apply == "NODES"
    drawn = drawn_in(image, in_editor)
    choices = [before[2] for before, entry in pairwise(drawn) if entry[0] == "prop_enum"]
    assert choices == [True, False, True]  # whether they are enabled
    assert "Movies are not" in str(drawn)


def test_a_movie_of_ten_bits_has_no_code_values(movie):
    image = load(movie("deep.mkv"))
    with pytest.raises(RuntimeError, match="movies of more than 8 bits"):
        bpy.ops.crf.estimate_response(image=image.name, apply="NODES")
    assert "camera_response" not in image


def test_nodes_linearize_a_movie(movie, codes, composited):
    image = load(movie("rgb.mkv"))
    estimate(image, "NODES")
    bpy.context.scene.frame_set(7)
    found = composited(group_node().outputs["Image"])[..., :3]
    assert np.abs(found - curve_of(image).inverse(frame_codes(codes, 7) / 255)).max() < 1e-5


def test_a_damaged_movie_is_one_sentence(addon, tmp_path):
    (tmp_path / "broken.mov").write_bytes(b"no movie" * 100)
    image = load(tmp_path / "broken.mov")
    with pytest.raises(RuntimeError, match=r"broken.mov: frame 1 cannot be read") as problem:
        bpy.ops.crf.estimate_response(image=image.name)
    assert len(str(problem.value).strip().splitlines()) == 1
    assert "camera_response" not in image


def test_of_a_movie_it_is_the_frame_that_the_editor_shows(movie, codes, in_editor):
    image = load(movie("rgb.mkv"))
    estimate(image)
    before = list(bpy.data.images)
    with in_editor("IMAGE_EDITOR") as space:
        space.image, space.image_user.frame_duration = image, FRAMES
        for number in (7, 2, 12, 1):
            bpy.context.scene.frame_set(number)
            show(after=True)
            expected = curve_of(image).inverse(frame_codes(codes, number) / 255)
            assert np.abs(pixels_of(space.image)[..., :3] - expected).max() < 1e-6
            show(after=False)
    assert len(bpy.data.images) == len(before) + 1  # the linear frame; no copy of the movie is left
    assert not image.is_dirty
