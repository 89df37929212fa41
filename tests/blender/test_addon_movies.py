"""Movies: the code values of the frame shown, estimates and errors."""

import numpy as np
import pytest

from tests.helpers.images import write_image

bpy = pytest.importorskip("bpy", reason="needs Blender's bpy module")

FRAMES = 12

#: Container, codec and bits of the movies: RGB without loss, YUV of limited range without further loss, RGB of 10 bits,
#: RGB with alpha.
CODECS = {
    "rgb.mkv": ("MKV", "FFV1", "8"),
    "yuv.mp4": ("MPEG4", "H264", "8"),
    "deep.mkv": ("MKV", "FFV1", "10"),
    "alpha.mov": ("QUICKTIME", "QTRLE", "8"),
}


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
            encode(
                path, [write_image(movie_folder / f"{n:04d}.png", frame_codes(codes, n)) for n in range(1, FRAMES + 1)]
            )
        return path

    return encoded


def encode(path, frames, color_mode="RGB"):
    """Encode 8-bit frames as they are."""
    container, codec, depth = CODECS[path.name]
    scene = bpy.data.scenes.new("Encoder")
    image = bpy.data.images.load(str(frames[0]))
    image.source = "SEQUENCE"
    image.colorspace_settings.name = "Non-Color"
    tree, output = empty_tree(scene)
    node = tree.nodes.new("CompositorNodeImage")
    node.image = image
    node.frame_duration, node.frame_start, node.frame_offset = len(frames), 1, 0
    multiplied = tree.nodes.new("CompositorNodePremulKey")  # by alpha, which the encoder divides by
    if bpy.app.version >= (5, 0, 0):
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
    settings.color_mode, settings.color_depth = "RGBA" if codec == "QTRLE" else color_mode, depth
    render.filepath, render.use_file_extension = str(path), False
    bpy.ops.render.render(animation=True, scene=scene.name)
    bpy.data.images.remove(image)
    bpy.data.scenes.remove(scene)


def empty_tree(scene):
    if bpy.app.version >= (5, 0, 0):
        tree = scene.compositing_node_group = bpy.data.node_groups.new("Encoder", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        return tree, tree.nodes.new("NodeGroupOutput")
    scene.use_nodes = True
    scene.node_tree.nodes.clear()
    return scene.node_tree, scene.node_tree.nodes.new("CompositorNodeComposite")


def stored_curve(datablock):
    from blender_addon.scene.stored_estimate import restored

    return restored(datablock).curve


def load(kind, path):
    return (bpy.data.images if kind == "image" else bpy.data.movieclips).load(str(path))


@pytest.mark.parametrize("kind", ["image", "clip"])
@pytest.mark.parametrize("number", [1, 7, 12])
def test_a_plate_holds_the_code_values_of_the_frame_shown(movie, codes, kind, number):
    from blender_addon.scene.plates import plate_of

    bpy.context.scene.frame_set(number)
    images = list(bpy.data.images)
    for name, most in (("rgb.mkv", 1), ("yuv.mp4", 2)):  # H.264 keeps 219 levels of brightness
        datablock = load(kind, movie(name))
        plate = plate_of(datablock)
        assert (plate.shown_frame, plate.frame_count) == (number, FRAMES)
        difference = plate.content.astype(int) - frame_codes(codes, number)
        assert np.abs(difference).max() <= most
        assert abs(difference.mean()) < 0.1
    assert [image for image in bpy.data.images if image not in images and kind == "clip"] == []


def test_a_movie_of_ten_bits_has_no_code_values(movie):
    image = load("image", movie("deep.mkv"))
    with pytest.raises(RuntimeError, match="movies of more than 8 bits"):
        bpy.ops.crf.estimate_response(image=image.name, apply="NODES")
    assert "camera_response" not in image


def test_a_movie_is_not_baked(movie, tmp_path):
    image = load("image", movie("rgb.mkv"))
    with pytest.raises(RuntimeError, match="movies are not baked"):
        bpy.ops.crf.estimate_response(image=image.name, apply="BAKE", folder=str(tmp_path / "out"))
    assert not (tmp_path / "out").exists()


def test_nodes_linearize_a_movie(movie, codes, composited):
    image = load("image", movie("rgb.mkv"))
    assert bpy.ops.crf.estimate_response(image=image.name, apply="NODES") == {"FINISHED"}
    bpy.context.scene.frame_set(7)
    from blender_addon.scene.compositor import compositor_tree

    tree = compositor_tree(bpy.context.scene)
    (node,) = (node for node in tree.nodes if node.type == "GROUP")
    found = composited(node.outputs["Image"])[..., :3]
    assert np.abs(found - stored_curve(image).inverse(frame_codes(codes, 7) / 255)).max() < 1e-5


def test_a_damaged_movie_is_one_sentence(addon, tmp_path):
    (tmp_path / "broken.mov").write_bytes(b"no movie" * 100)
    image = bpy.data.images.load(str(tmp_path / "broken.mov"))
    with pytest.raises(RuntimeError, match=r"broken.mov: frame 1 cannot be read") as problem:
        bpy.ops.crf.estimate_response(image=image.name)
    assert len(str(problem.value).strip().splitlines()) == 1
    assert "camera_response" not in image


def test_of_a_movie_it_is_the_frame_that_the_editor_shows(movie, codes, in_editor):
    """Not the one that Blender has read last, here the first."""
    from .test_addon_image_tools import pixels_of

    image = load("image", movie("rgb.mkv"))
    bpy.ops.crf.estimate_response(image=image.name)
    before = list(bpy.data.images)
    with in_editor("IMAGE_EDITOR") as space:
        space.image, space.image_user.frame_duration = image, FRAMES
        for number in (7, 2, 12, 1):
            bpy.context.scene.frame_set(number)
            assert bpy.ops.crf.compare(is_after=True) == {"FINISHED"}
            expected = stored_curve(image).inverse(frame_codes(codes, number) / 255)
            assert np.abs(pixels_of(space.image)[..., :3] - expected).max() < 1e-6
            bpy.ops.crf.compare(is_after=False)
    assert len(bpy.data.images) == len(before) + 1  # the linear frame; no copy of the movie is left
    assert not image.is_dirty
