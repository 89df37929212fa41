import csv
import struct

import numpy as np
import OpenImageIO as oiio
import pytest

pytest.importorskip("rawpy", reason="bringing photographs needs the train extra")

from crfnet_core.errors import PhotoError
from training.data.import_scenes import COLUMNS, import_scene, main
from training.data.linear_files import automatic_scale, linear_scene
from training.data.scenes import area_averaged, read_scene, split_scenes

#: Linear Rec.709 to CIE XYZ (IEC 61966-2-1), and XYZ to the RGB of two cameras: in the order of magnitude of real ones.
XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
CAMERAS = {
    "one": np.array([[0.70, -0.10, -0.08], [-0.45, 1.22, 0.22], [-0.10, 0.20, 0.65]]),
    "two": np.array([[0.92, -0.30, -0.10], [-0.38, 1.18, 0.20], [-0.05, 0.15, 0.55]]),
}

#: TIFF's field types: struct code and the size of one value.
BYTE, ASCII, SHORT, LONG, RATIONAL, SRATIONAL = (1, "B"), (2, "s"), (3, "H"), (4, "I"), (5, "I"), (10, "i")

PATCH = 32  # sensor pixels along a side


def patches(values, rows=8, columns=10):
    """Return a scene (H, W, 3) of flat patches, `values` (N, 3) repeated over rows x columns of them."""
    values = np.resize(np.asarray(values, dtype=np.float64), (rows * columns, 3)).reshape(rows, columns, 3)
    return values.repeat(PATCH, axis=0).repeat(PATCH, axis=1)


def ramp(top):
    """Return eighty gray patches, brightest `top`, half a stop apart and then again from the top."""
    return np.repeat(top * 2.0 ** -(np.arange(16) / 2)[:, None], 3, axis=1)


def patch_means(pixels, size):
    """Return the mean of the middle half of each patch of `size` samples, shape (rows, columns, 3)."""
    rows, columns = (side // size for side in pixels.shape[:2])
    quarter = size // 4
    cells = pixels[: rows * size, : columns * size].reshape(rows, size, columns, size, 3)
    return cells[:, quarter:-quarter, :, quarter:-quarter].astype(np.float64).mean(axis=(1, 3))


def write_dng(path, scene, *, camera="one", pattern="RGGB", light=(1, 1, 1), black=1024, white=65000, orientation=1):
    """Write the Bayer mosaic that a camera takes of a scene-linear Rec.709 scene, (H, W, 3), as a 16-bit DNG 1.4.

    The scene stands under a light of this colour, for which the camera is balanced; a gray of 1 saturates its most
    sensitive channel.
    """
    to_camera = CAMERAS[camera] @ XYZ * light
    neutral = to_camera.sum(axis=1)
    sensed = np.clip(scene @ (to_camera / neutral.max()).T, 0, 1)
    mosaic = np.zeros(scene.shape[:2], dtype="<u2")
    for place, name in enumerate(pattern):
        own = np.s_[place // 2 :: 2, place % 2 :: 2]
        mosaic[own] = np.rint(black + (white - black) * sensed[(*own, "RGB".index(name))])
    height, width = mosaic.shape
    write_tiff(
        path,
        mosaic.tobytes(),
        {
            256: (LONG, [width]),
            257: (LONG, [height]),
            258: (SHORT, [16]),
            259: (SHORT, [1]),
            262: (SHORT, [32803]),  # colour filter array
            271: (ASCII, b"Formula\0"),
            272: (ASCII, camera.encode() + b"\0"),
            274: (SHORT, [orientation]),
            277: (SHORT, [1]),
            278: (LONG, [height]),
            33421: (SHORT, [2, 2]),
            33422: (BYTE, ["RGB".index(name) for name in pattern]),
            50706: (BYTE, [1, 4, 0, 0]),
            50708: (ASCII, b"Formula " + camera.encode() + b"\0"),
            50714: (SHORT, [black]),
            50717: (SHORT, [white]),
            50721: (SRATIONAL, fractions(CAMERAS[camera])),  # XYZ to camera
            50728: (RATIONAL, fractions(neutral / neutral.max())),  # as shot
            50778: (SHORT, [21]),  # D65
        },
    )
    return path


def write_tiff(path, strip, fields):
    """Write a little-endian TIFF file of one directory and one strip."""
    fields = {254: (LONG, [0]), **fields, 273: (LONG, [0]), 279: (LONG, [len(strip)])}
    offset = 8 + 2 + 12 * len(fields) + 4
    entries, values = b"", b""
    for tag, ((kind, code), numbers) in sorted(fields.items()):
        if tag == 273:
            numbers = [offset + sum((len(packed(*field)) + 1) // 2 * 2 for field in fields.values())]
        content = packed((kind, code), numbers)
        count = len(content) // {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 10: 8}[kind]
        place = content.ljust(4, b"\0") if len(content) <= 4 else struct.pack("<I", offset + len(values))
        entries += struct.pack("<HHI", tag, kind, count) + place
        values += content.ljust((len(content) + 1) // 2 * 2, b"\0")
    directory = struct.pack("<H", len(fields)) + entries + bytes(4)
    path.write_bytes(b"II*\0" + struct.pack("<I", 8) + directory + values + strip)


def fractions(numbers):
    """Return numerators and denominators, shape (N, 2)."""
    return np.stack([np.rint(np.ravel(numbers) * 10**6), np.full(np.size(numbers), 10**6)], axis=1)


def packed(kind, numbers):
    """Return the bytes of a TIFF field's values."""
    flat = [int(number) for number in np.ravel(numbers)] if kind != ASCII else []
    return numbers if kind == ASCII else struct.pack(f"<{len(flat)}{kind[1]}", *flat)


def write_float(path, pixels, kind=oiio.FLOAT, names="RGB"):
    """Write (H, W, C) samples as OpenEXR or Radiance HDR, by the suffix."""
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, kind)
    spec.channelnames = tuple(names)
    image = oiio.ImageBuf(spec)
    image.set_pixels(image.roi, np.ascontiguousarray(pixels, dtype=np.float32))
    assert image.write(str(path)), image.geterror()
    return path


def pixels_of(path):
    return oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)


def manifest(folder):
    with (folder / "manifest.csv").open(newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture
def out(tmp_path):
    return tmp_path / "data" / "linear"


@pytest.mark.parametrize(("camera", "pattern"), [("one", "RGGB"), ("two", "BGGR"), ("one", "GRBG")])
def test_raw_grays_are_the_scene(tmp_path, out, camera, pattern):
    scene = patches(ramp(1.0))
    import_scene(write_dng(tmp_path / "ramp.dng", scene, camera=camera, pattern=pattern), out)
    means = patch_means(pixels_of(out / "ramp.exr"), PATCH)
    np.testing.assert_allclose(means, patch_means(scene, PATCH), rtol=0.01)


def test_grays_under_a_warm_light_are_balanced_as_the_camera_did(tmp_path, out):
    scene = patches(ramp(1.0))
    import_scene(write_dng(tmp_path / "warm.dng", scene, light=(1.5, 1.0, 0.4)), out)
    means = patch_means(pixels_of(out / "warm.exr"), PATCH)
    np.testing.assert_allclose(means, patch_means(scene, PATCH), rtol=0.01)


@pytest.mark.parametrize("camera", ["one", "two"])
def test_raw_colours_are_the_scene_in_rec709(tmp_path, out, camera):
    colours = [[0.8, 0.2, 0.1], [0.1, 0.6, 0.2], [0.15, 0.2, 0.7], [0.6, 0.5, 0.1], [0.1, 0.5, 0.5], [0.25, 0.2, 0.15]]
    scene = patches(colours)
    import_scene(write_dng(tmp_path / "colours.dng", scene, camera=camera), out)
    means = patch_means(pixels_of(out / "colours.exr"), PATCH)
    np.testing.assert_allclose(means, patch_means(scene, PATCH), rtol=0.01)


def test_double_the_light_is_double_the_value_and_white_clips_at_1(tmp_path, out):
    values = []
    for top in (0.45, 0.9, 1.8):  # LibRaw would by itself take 0.9 for white
        import_scene(write_dng(tmp_path / f"top{top}.dng", patches(ramp(top))), out)
        values.append(patch_means(pixels_of(out / f"top{top}.exr"), PATCH))
    np.testing.assert_allclose(values[0][0, 0], 0.45, rtol=0.01)
    dark = 5 / 65535  # LibRaw rounds down a few times
    np.testing.assert_allclose(values[1], 2 * values[0], rtol=0.005, atol=dark)
    np.testing.assert_array_equal(values[2][0, 0], [1, 1, 1])
    np.testing.assert_allclose(values[2], np.minimum(1, 4 * values[0]), rtol=0.005, atol=2 * dark)


def test_a_saturated_colour_clips_channel_by_channel_below_or_at_1(tmp_path, out):
    import_scene(write_dng(tmp_path / "red.dng", patches([[4.0, 0.4, 0.2]])), out)
    means = patch_means(pixels_of(out / "red.exr"), PATCH)[0, 0]
    assert means[0] == 1
    assert (means[1:] < 1).all()


def test_raw_is_averaged_in_linear_light_to_a_shorter_side_of_454(tmp_path, out, capsys):
    scene = patches(ramp(1.0), rows=30, columns=40)  # 960 x 1280
    path = write_dng(tmp_path / "large.dng", scene)
    assert main([str(path), "--out", str(out), "--licence", "CC0"]) == 0
    means = patch_means(pixels_of(out / "large.exr"), PATCH // 2)
    np.testing.assert_allclose(means, patch_means(scene, PATCH), rtol=0.01)
    assert manifest(out) == [
        {
            "file": "large.exr",
            "kind": "photograph",
            "width": "640",
            "height": "480",
            "source": "brought: large.dng",
            "licence": "CC0",
            "notes": "sensor white = 1; area-averaged 2x2 from 1280x960",
        }
    ]
    assert capsys.readouterr().out.endswith(
        "large.exr: photograph, 640 x 480, sensor white = 1; area-averaged 2x2 from 1280x960\n"
    )


def test_raw_stays_as_stored_whatever_its_orientation(tmp_path, out):
    row = import_scene(write_dng(tmp_path / "turned.dng", patches(ramp(1.0)), orientation=6), out)
    assert (row.width, row.height) == (320, 256)


def test_the_same_file_gives_the_same_bytes(tmp_path):
    path = write_dng(tmp_path / "ramp.dng", patches(ramp(1.0)))
    contents = []
    for folder in (tmp_path / "a", tmp_path / "b"):
        import_scene(path, folder)
        contents.append([(file.name, file.read_bytes()) for file in sorted(folder.iterdir())])
    assert contents[0] == contents[1]
    assert [name for name, _ in contents[0]] == ["manifest.csv", "ramp.exr"]
    assert "DateTime" not in oiio.ImageBuf(str(tmp_path / "a" / "ramp.exr")).spec().serialize("text", "detailed")


@pytest.mark.parametrize(
    ("shape", "scale"), [((227, 900), 1), ((907, 4000), 1), ((908, 1000), 2), ((4000, 6000), 8), ((1361, 1361), 2)]
)
def test_automatic_scale(shape, scale):
    assert automatic_scale(*shape) == scale


def test_area_averaging_drops_the_incomplete_rest():
    samples = np.arange(5 * 7).reshape(5, 7, 1).repeat(3, axis=2)
    np.testing.assert_array_equal(area_averaged(samples, 2)[:, :, 1], [[4, 6, 8], [18, 20, 22]])


def test_exr_is_scaled_by_a_power_of_two_without_negative_values(tmp_path):
    light = np.full((240, 300, 3), 20.0)
    light[0, 0] = [-5, np.nan, 3]
    light[1, 1] = 1e8
    pixels, notes = linear_scene(write_float(tmp_path / "a.exr", light))
    assert pixels.dtype == np.float16
    assert pixels[100, 100].tolist() == [0.15625] * 3  # 20 / 2**7
    assert pixels[0, 0].tolist() == [0, 0, 3 / 128]
    assert pixels[1, 1].tolist() == [65000 // 32 * 32] * 3  # the steps of half floats there
    assert notes == ["scale=2^-7", "4.6e-06 negative samples set to 0", "1 px clipped at 65000 after scale"]


def test_hdr_is_averaged_in_linear_light(tmp_path):
    light = np.full((460, 460, 3), 0.25)
    light[::2, ::2] = 1.0
    pixels, notes = linear_scene(write_float(tmp_path / "a.hdr", light), scale=2)
    np.testing.assert_array_equal(pixels, np.full((230, 230, 3), 0.4375 / 2, np.float16))
    assert notes == ["scale=2^-1", "area-averaged 2x2 from 460x460"]


def test_gray_exr_has_three_equal_channels(tmp_path, out):
    import_scene(write_float(tmp_path / "gray.exr", np.full((240, 240, 1), 0.18), names="Y"), out)
    np.testing.assert_array_equal(pixels_of(out / "gray.exr"), np.full((240, 240, 3), np.float16(0.18), np.float32))


def test_a_panorama_keeps_the_rows_around_its_horizon(tmp_path, out):
    light = np.ones((300, 600, 3)) * np.arange(1, 301)[:, None, None]
    row = import_scene(write_float(tmp_path / "sky.hdr", light), out, kind="panorama")
    assert (row.kind, row.width, row.height) == ("panorama band", 600, 240)
    assert pixels_of(out / "sky.exr")[0, 0, 0] == pytest.approx(31 / 1024, rel=0.01)


def test_a_photograph_is_no_panorama(tmp_path):
    path = write_dng(tmp_path / "ramp.dng", patches(ramp(1.0)))
    with pytest.raises(PhotoError, match="320 x 256 is no whole panorama"):
        linear_scene(path, is_panorama=True)


def test_training_reads_the_new_folder(tmp_path, out):
    for name, top in (("a", 0.5), ("b", 1.0), ("c", 2.0)):
        import_scene(write_dng(tmp_path / f"{name}.dng", patches(ramp(top))), out)
    scene = read_scene(out / "b.exr", False)
    assert scene.pixels.shape == (256, 320, 3)
    luminance = scene.pixels @ [0.2126, 0.7152, 0.0722]
    assert np.exp(np.log(luminance).mean()) == pytest.approx(1, abs=1e-4)
    named = [scene for scenes in split_scenes(out).values() for scene in scenes]
    assert sorted(named) == [("a.exr", False), ("b.exr", False), ("c.exr", False)]


def test_a_name_is_only_replaced_when_asked(tmp_path, out, capsys):
    first = write_dng(tmp_path / "same.dng", patches(ramp(1.0)))
    assert main([str(first), "--out", str(out)]) == 0
    other = write_float(tmp_path / "same.exr", np.full((230, 240, 3), 0.5))
    assert main([str(other), "--out", str(out)]) == 2
    assert "same.exr is there already; rename the file or ask to overwrite it" in capsys.readouterr().err
    assert manifest(out)[0]["source"] == "brought: same.dng"
    assert main([str(other), "--out", str(out), "--overwrite"]) == 0
    assert [(row["source"], row["width"]) for row in manifest(out)] == [("brought: same.exr", "240")]
    assert pixels_of(out / "same.exr").shape == (230, 240, 3)


def test_a_name_of_the_manifest_is_taken_though_its_file_is_away(tmp_path, out):
    path = write_dng(tmp_path / "ramp.dng", patches(ramp(1.0)))
    import_scene(path, out)
    (out / "ramp.exr").unlink()
    with pytest.raises(PhotoError, match="is there already"):
        import_scene(path, out)


def test_a_file_of_the_folder_itself_is_refused(tmp_path, out):
    import_scene(write_dng(tmp_path / "ramp.dng", patches(ramp(1.0))), out)
    with pytest.raises(PhotoError, match="is a file of the folder"):
        import_scene(out / "ramp.exr", out, overwrite=True)


def test_the_manifest_keeps_what_it_holds(tmp_path, out):
    out.mkdir(parents=True)
    text = ",".join(COLUMNS) + '\nold.exr,photograph,600,400,elsewhere,CC0,"one, two"\n'
    (out / "manifest.csv").write_text(text)
    import_scene(write_dng(tmp_path / "new.dng", patches(ramp(1.0))), out)
    expected = text + "new.exr,photograph,320,256,brought: new.dng,not stated,sensor white = 1\n"
    assert (out / "manifest.csv").read_text() == expected


def test_another_manifest_is_refused(tmp_path, out):
    out.mkdir(parents=True)
    (out / "manifest.csv").write_text("name,split\na.exr,train\n")
    with pytest.raises(PhotoError, match=r"needs the columns file, kind, width, .*, and no more; found name, split"):
        import_scene(write_dng(tmp_path / "new.dng", patches(ramp(1.0))), out)
    assert [path.name for path in out.iterdir()] == ["manifest.csv"]


def test_a_folder_that_cannot_be_made_is_refused(tmp_path, capsys):
    (tmp_path / "file").write_text("no folder")
    path = write_dng(tmp_path / "new.dng", patches(ramp(1.0)))
    assert main([str(path), "--out", str(tmp_path / "file" / "linear")]) == 2
    assert "linear: cannot be made (Not a directory); choose another folder" in capsys.readouterr().err


def test_two_files_of_one_name_are_refused(tmp_path, out, capsys):
    (tmp_path / "other").mkdir()
    files = [write_dng(folder / "same.dng", patches(ramp(1.0))) for folder in (tmp_path, tmp_path / "other")]
    assert main([*map(str, files), "--out", str(out)]) == 2
    assert capsys.readouterr().err.count("2 of these files would become same.exr") == 2
    assert not out.exists()


def bad_files(folder):
    """Write files that cannot be imported; return name -> what is said of each."""
    whole = write_dng(folder / "whole.dng", patches(ramp(1.0))).read_bytes()
    exr = write_float(folder / "whole.exr", np.full((240, 240, 3), 0.5)).read_bytes()
    encoded = oiio.ImageBuf(oiio.ImageSpec(240, 240, 3, oiio.UINT8))
    for name in ("jpeg.jpg", "png.png", "tiff.tif"):
        assert encoded.write(str(folder / name))
    contents = {
        "cut.dng": whole[: len(whole) // 2],
        "short.exr": exr[: len(exr) // 2],
        "empty.nef": b"",
        "blank.hdr": b"",
    }
    contents |= {"renamed.cr2": (folder / "jpeg.jpg").read_bytes()}
    for name, content in contents.items():
        (folder / name).write_bytes(content)
    write_float(folder / "codes.exr", np.full((240, 240, 3), 7), oiio.UINT32)
    write_float(folder / "depth.exr", np.full((240, 240, 2), 0.5), names=("X", "Z"))
    write_float(folder / "small.hdr", np.full((226, 400, 3), 0.5))
    write_float(folder / "black.exr", np.zeros((240, 240, 3)))
    write_float(folder / "endless.exr", np.full((240, 240, 3), np.inf))
    return {
        "jpeg.jpg": "is not scene-linear; give camera raw, OpenEXR or Radiance HDR",
        "png.png": "is not scene-linear",
        "tiff.tif": "is not scene-linear",
        "cut.dng": "LibRaw cannot develop it (Input/output error)",
        "short.exr": "is damaged or cut short",
        "empty.nef": "LibRaw cannot develop it",
        "blank.hdr": "is not scene-linear",
        "renamed.cr2": "LibRaw cannot develop it (Unsupported file format or not RAW file)",
        "codes.exr": "holds no flat picture of half or float samples",
        "depth.exr": "needs channels R, G and B, or a gray one; found X, Z",
        "small.hdr": "226 rows or columns at scale 1 are too few; windows need 227",
        "black.exr": "is black",
        "endless.exr": "is black",
        "absent.nef": "there is no such file",
    }


def test_bad_files_are_one_line_each_and_stop_no_others(tmp_path, out, capsys):
    said = bad_files(tmp_path)
    good = write_float(tmp_path / "good.exr", np.full((240, 240, 3), 0.5))
    assert main([*(str(tmp_path / name) for name in said), str(good), "--out", str(out)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == len(said)
    for line, (name, text) in zip(lines, said.items(), strict=True):
        assert line.startswith(f"import_scenes: error: {tmp_path / name}: ")
        assert text in line
    assert sorted(path.name for path in out.iterdir()) == ["good.exr", "manifest.csv"]
    assert [row["file"] for row in manifest(out)] == ["good.exr"]


@pytest.mark.parametrize("scale", [0, -1, 2])
def test_a_scale_must_leave_room_for_a_window(tmp_path, scale):
    path = write_dng(tmp_path / "ramp.dng", patches(ramp(1.0)))
    with pytest.raises(PhotoError, match=r"is none; give 1 or more|256 rows or columns at scale 2 are too few"):
        linear_scene(path, scale=scale)


def test_an_exr_that_calls_itself_encoded_is_refused(tmp_path):
    spec = oiio.ImageSpec(240, 240, 3, oiio.HALF)
    spec.attribute("colorInteropID", "srgb_rec709_scene")
    image = oiio.ImageBuf(spec)
    assert image.write(str(tmp_path / "encoded.exr"))
    with pytest.raises(PhotoError, match="calls itself srgb_rec709_scene, which is not scene-linear"):
        linear_scene(tmp_path / "encoded.exr")
