import numpy as np
import pytest

from crfnet_core.errors import PhotoError
from tests.helpers.images import read_image, write_image
from tests.helpers.linear_pictures import chart, manifest, ramp, write_dng, write_float
from training.data.import_scenes import import_scene, main
from training.data.linear_files import linear_scene
from training.data.scenes import read_scene
from training.data.splits import split_scenes


def test_training_reads_the_new_folder(tmp_path, out):
    for name, top in (("a", 0.5), ("b", 1.0), ("c", 2.0)):
        import_scene(write_dng(tmp_path / f"{name}.dng", chart(ramp(top))), out)
    scene = read_scene(out / "b.exr", False)
    assert scene.pixels.shape == (256, 320, 3)
    luminance = scene.pixels @ [0.2126, 0.7152, 0.0722]
    assert np.exp(np.log(luminance).mean()) == pytest.approx(1, abs=1e-4)
    named = [scene for scenes in split_scenes(out).values() for scene in scenes]
    assert sorted(named) == [("a.exr", False), ("b.exr", False), ("c.exr", False)]


def test_a_name_that_is_taken_is_refused(tmp_path, out, capsys):
    first = write_dng(tmp_path / "same.dng", chart(ramp(1.0)))
    assert main([str(first), "--out", str(out)]) == 0
    other = write_float(tmp_path / "same.exr", np.full((230, 240, 3), 0.5))
    assert main([str(other), "--out", str(out)]) == 2
    assert "same.exr is there already; rename the file" in capsys.readouterr().err
    assert [row["source"] for row in manifest(out)] == ["imported: same.dng"]
    assert read_image(out / "same.exr").shape == (256, 320, 3)


def test_another_manifest_is_refused(tmp_path, out):
    out.mkdir(parents=True)
    (out / "manifest.csv").write_text("name,split\na.exr,train\n")
    with pytest.raises(PhotoError, match=r"needs the columns file, kind, width, .*, and no more; found name, split"):
        import_scene(write_dng(tmp_path / "new.dng", chart(ramp(1.0))), out)
    assert [path.name for path in out.iterdir()] == ["manifest.csv"]


def bad_files(folder):
    """Write files that cannot be imported; return name -> what is said of each."""
    whole = write_dng(folder / "whole.dng", chart(ramp(1.0))).read_bytes()
    exr = write_float(folder / "whole.exr", np.full((240, 240, 3), 0.5)).read_bytes()
    write_image(folder / "jpeg.jpg", np.zeros((240, 240, 3), np.uint8))
    contents = {"cut.dng": whole[: len(whole) // 2], "short.exr": exr[: len(exr) // 2], "blank.hdr": b""}
    contents |= {"renamed.cr2": (folder / "jpeg.jpg").read_bytes()}
    for name, content in contents.items():
        (folder / name).write_bytes(content)
    write_float(folder / "codes.exr", np.full((240, 240, 3), 7), "uint")
    write_float(folder / "depth.exr", np.full((240, 240, 2), 0.5), names=("X", "Z"))
    write_float(folder / "small.hdr", np.full((226, 400, 3), 0.5))
    write_float(folder / "black.exr", np.zeros((240, 240, 3)))
    write_float(folder / "endless.exr", np.full((240, 240, 3), np.inf))
    write_image(folder / "encoded.exr", np.zeros((240, 240, 3), np.float16), colorInteropID="srgb_rec709_scene")
    return {
        "jpeg.jpg": "is not scene-linear; give camera raw, OpenEXR or Radiance HDR",
        "cut.dng": "LibRaw cannot develop it (Input/output error)",
        "short.exr": "is damaged or cut short",
        "blank.hdr": "is not scene-linear",
        "renamed.cr2": "LibRaw cannot develop it (Unsupported file format or not RAW file)",
        "codes.exr": "is deep, a volume, or not of half or float samples",
        "depth.exr": "needs channels R, G and B, or a gray one; found X, Z",
        "small.hdr": "226 rows or columns are too few; windows need 227",
        "black.exr": "is black",
        "endless.exr": "is black",
        "encoded.exr": "calls itself srgb_rec709_scene, which is not scene-linear",
        "absent.nef": "No such file",
    }


def test_bad_files_are_one_line_each_and_stop_no_others(tmp_path, out, capsys):
    said = bad_files(tmp_path)
    good = write_float(tmp_path / "good.exr", np.full((240, 240, 3), 0.5))
    assert main([*(str(tmp_path / name) for name in said), str(good), "--out", str(out)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == len(said)
    for line, (name, text) in zip(lines, said.items(), strict=True):
        assert line.startswith("import_scenes: error: ")
        assert str(tmp_path / name) in line
        assert text in line
    assert sorted(path.name for path in out.iterdir()) == ["good.exr", "manifest.csv"]
    assert [row["file"] for row in manifest(out)] == ["good.exr"]


def test_channels_are_named_even_if_their_names_are_not_utf8(tmp_path):
    path = write_float(tmp_path / "odd.exr", np.full((240, 240, 2), 0.5), names=("X", "Zone"))
    path.write_bytes(path.read_bytes().replace(b"Zone", b"Z\xffne"))
    with pytest.raises(PhotoError, match="found X, Z\udcffne"):
        linear_scene(path)
