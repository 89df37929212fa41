"""Movies, which another Blender decodes: their code values, estimates, bakes and errors."""

import tempfile

import numpy as np
import pytest

from tests.helpers.images import read_image, write_image

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


@pytest.fixture
def decoded(addon):
    """Decode frames of a file: decoded(path, numbers) -> their samples."""

    def decode(path, numbers, sample="uint8"):
        from blender_addon.scene.plates import plate_of
        from blender_addon.work.frame_files import frame_reader, frames_of
        from crfnet.plates.frames import FrameSequence

        plate = plate_of(load("image", path))
        frames = frames_of(plate)
        with frame_reader(plate) as read:
            paths = tuple(frames.paths[n - 1] for n in numbers)
            files = read(FrameSequence(paths, tuple(numbers)), None).paths
            return [as_stored(file) if sample == "stored" else read_image(file, kind=sample) for file in files]

    return decode


def as_stored(path):
    """Codes with alpha, not multiplied by it."""
    from crfnet_core.photograph.image_io import read_codes

    values = read_codes(path)
    return np.dstack([values.codes, values.alpha])


def test_a_movie_is_decoded_to_its_code_values(movie, decoded, codes):
    for number, found in zip((1, 12, 7), decoded(movie("rgb.mkv"), (1, 12, 7)), strict=True):
        assert found.shape == (256, 256, 3)
        assert np.abs(found.astype(int) - frame_codes(codes, number)).max() <= 1


def test_yuv_of_limited_range_is_expanded(movie, decoded, codes):
    """H.264 keeps 219 levels of brightness, so codes are off by up to two; without the expansion, by up to 20."""
    (found,) = decoded(movie("yuv.mp4"), (7,))
    difference = found.astype(int) - frame_codes(codes, 7)
    assert np.abs(difference).max() <= 2
    assert abs(difference.mean()) < 0.1


def test_ten_bits_are_kept(movie, decoded, codes):
    (found,) = decoded(movie("deep.mkv"), (7,), sample="uint16")
    assert np.abs(found / 65535 - frame_codes(codes, 7) / 255).max() < 2 / 1023
    assert len(np.unique(found % 257)) > 1  # not 8 bits made wider


def test_alpha_is_kept_and_colors_are_not_multiplied_by_it(addon, movie_folder, decoded, codes):
    path, alpha = movie_folder / "alpha.mov", np.maximum(codes[..., :1], 1)
    if not path.is_file():
        samples = np.dstack([codes, alpha])
        encode(path, [write_image(movie_folder / f"a{n}.png", samples, oiio__UnassociatedAlpha=1) for n in (1, 2)])
    (found,) = decoded(path, (1,), sample="stored")
    image = bpy.data.images.load(str(path))
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    shown = np.rint(pixels.reshape(256, 256, 4)[::-1] * 255)  # the decoder's code values
    assert len(np.unique(shown[..., 3])) == 255
    np.testing.assert_array_equal(found, shown)


@pytest.mark.parametrize("kind", ["image", "clip"])
def test_a_movie_is_baked_as_a_sequence(movie, codes, tmp_path, kind):
    datablock = load(kind, movie("rgb.mkv"))
    options = {"apply": "BAKE", "depth": "float", "folder": str(tmp_path / "out")}
    assert bpy.ops.crf.estimate_response(**{kind: datablock.name}, **options) == {"FINISHED"}
    files = sorted((tmp_path / "out").iterdir())
    assert [path.name for path in files] == [f"rgb_linear.{n:04d}.exr" for n in range(1, FRAMES + 1)]
    curve = stored_curve(datablock)
    for number in (1, 9, 12):
        expected = curve.inverse(frame_codes(codes, number) / 255)
        assert np.abs(read_image(files[number - 1]) - expected).max() < 1e-6
    baked = (bpy.data.images if kind == "image" else bpy.data.movieclips)["rgb_linear.0001.exr"]
    assert baked.source == "SEQUENCE"


def test_a_baked_movie_has_the_same_bytes_again(movie, tmp_path):
    datablock = load("image", movie("rgb.mkv"))
    for name in ("a", "b"):
        bpy.ops.crf.estimate_response(image=datablock.name, apply="BAKE", folder=str(tmp_path / name))
    first, second = (sorted((tmp_path / name).iterdir()) for name in ("a", "b"))
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in second]


def test_the_estimate_is_that_of_its_frames(addon, movie, movie_folder):
    from blender_addon.scene.stored_estimate import restored
    from crfnet.plates.frames import find_frames, sample_frames
    from crfnet_core import AnalysisOptions, ResponseNetwork, estimate_response, read_photo
    from crfnet_core.network import DEFAULT_MODEL

    if not DEFAULT_MODEL.is_dir():
        pytest.skip("the packaged model is not there")
    addon.model = ""
    clip = load("clip", movie("rgb.mkv"))
    bpy.ops.crf.estimate_response(clip=clip.name, apply="NODES")
    frames = sample_frames(find_frames(movie_folder / "%04d.png"))
    expected = estimate_response(
        map(read_photo, frames), network=ResponseNetwork.load(), options=AnalysisOptions(use_metadata=False)
    )
    assert restored(clip).photos[-1] == "rgb.0012.png"
    np.testing.assert_array_equal(restored(clip).weights, expected.weights)


def test_nodes_linearize_a_movie(movie, codes, composited):
    image = load("image", movie("rgb.mkv"))
    assert bpy.ops.crf.estimate_response(image=image.name, apply="NODES") == {"FINISHED"}
    bpy.context.scene.frame_set(7)
    from blender_addon.scene.compositor import compositor_tree

    tree = compositor_tree(bpy.context.scene)
    (node,) = (node for node in tree.nodes if node.type == "GROUP")
    found = composited(node.outputs["Image"])[..., :3]
    assert np.abs(found - stored_curve(image).inverse(frame_codes(codes, 7) / 255)).max() < 1e-5


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    """The folder for temporary files, which is empty."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


def test_nothing_temporary_remains(movie, temporary, plate_file):
    bpy.ops.crf.estimate_response(image=load("image", movie("rgb.mkv")).name, apply="NODES")
    packed = bpy.data.images.load(str(plate_file))
    packed.pack()
    bpy.ops.crf.estimate_response(image=packed.name, apply="BAKE", folder=str(temporary.parent / "out"))
    assert list(temporary.iterdir()) == []


def test_a_cancelled_movie_ends_the_other_blender(movie, temporary):
    from blender_addon.scene.plates import plate_of
    from blender_addon.work.errors import CancelledError
    from blender_addon.work.frame_files import frame_reader, frames_of

    def cancel(done, total):
        assert (done, total) == (0, FRAMES)
        raise CancelledError("Cancelled")

    plate = plate_of(load("image", movie("rgb.mkv")))
    with frame_reader(plate) as read:
        process = read.__self__._process
        with pytest.raises(CancelledError):
            read(frames_of(plate), cancel)
        assert process.poll() is None
    assert process.poll() is not None
    assert list(temporary.iterdir()) == []


def test_a_damaged_movie_is_one_sentence(addon, tmp_path):
    (tmp_path / "broken.mov").write_bytes(b"no movie" * 100)
    image = bpy.data.images.load(str(tmp_path / "broken.mov"))
    with pytest.raises(RuntimeError, match=r"broken.mov.*Blender cannot decode it \(it is damaged") as problem:
        bpy.ops.crf.estimate_response(image=image.name)
    assert len(str(problem.value).strip().splitlines()) == 1
    assert "camera_response" not in image


def test_a_movie_needs_no_blender_of_its_own_once_estimated(movie, tmp_path, monkeypatch):
    image = load("image", movie("rgb.mkv"))
    bpy.ops.crf.estimate_response(image=image.name, apply="NODES")
    monkeypatch.setattr("blender_addon.work.frame_files.running_decoder", None)
    done = bpy.ops.crf.apply_response(image=image.name, apply="EXPORT", folder=str(tmp_path / "look"))
    assert done == {"FINISHED"}


def test_a_movie_of_ten_bits_is_not_compared_but_says_why(movie, in_editor):
    """Its pixels are floats that Blender has made linear by the colour space."""
    image = load("image", movie("deep.mkv"))
    with in_editor("IMAGE_EDITOR") as space:
        space.image = image
        bpy.ops.crf.estimate_response()
        with pytest.raises(RuntimeError, match=r"deep.mkv: movies of more than 8 bits .* choose Nodes or Bake"):
            bpy.ops.crf.compare(is_after=True)
        assert space.image == image


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
    assert list(bpy.data.images) == before
    assert not image.is_dirty
