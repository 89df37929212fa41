"""A response from a LUT file in place of an estimate."""

import numpy as np
import pytest

from crfnet.luts.files import read_lut, write_lut
from crfnet.luts.lut1d import Lut1D, inverse_response_lut

from .helpers import apply, bpy, curve_of, drawn_in, estimate, group_node, labels, operators, reopen, stored_estimate


@pytest.fixture
def lut_file(tmp_path, true_response):
    """Write the inverse of a known response in a format; returns its file."""

    def write(suffix=".spi1d"):
        path = tmp_path / f"camera{suffix}"
        write_lut(path, inverse_response_lut(true_response))
        return path

    return write


def load(image, path):
    return bpy.ops.crf.load_lut(image=image.name, filepath=str(path))


@pytest.mark.parametrize("suffix", [".spi1d", ".cube", ".clf"])
def test_the_response_of_the_file_is_stored(image, lut_file, true_response, suffix):
    assert load(image, lut_file(suffix)) == {"FINISHED"}
    found = curve_of(image)
    assert np.abs(found.brightness - true_response.brightness).max() < 2e-4
    assert (image.camera_response.verdict, image.camera_response.origin) == ("", f"Loaded from camera{suffix}")


def test_the_panel_says_so_and_has_no_verdict(image, lut_file, in_editor):
    assert "crf.load_lut" in [name for name, *_ in operators(drawn_in(image, in_editor))]
    load(image, lut_file())
    image.camera_response_settings.apply = "NODES"
    drawn = drawn_in(image, in_editor)
    words = " ".join(labels(drawn))
    assert next(entry for entry in drawn if entry[0] == "label") == ("label", "From a LUT", "FILE")
    assert "Loaded from camera.spi1d" in words
    assert not [word for word in ("Usable", "Expected error", "windows agree") if word in words]
    assert ("crf.apply_response", "Apply") in operators(drawn)


def test_it_is_applied_in_nodes_and_files(image, lut_file, tmp_path, codes, composited, true_response):
    load(image, lut_file())
    apply(image)
    linear = composited(group_node().outputs[0])[..., :3]
    assert np.abs(linear - true_response.inverse(codes / 255)).max() < 5e-5
    apply(image, "EXPORT")
    exported = [path for path in tmp_path.glob("*.spi1d") if path.name != "camera.spi1d"]
    assert [read_lut(path).comments for path in exported] == [("Inverse response, loaded from camera.spi1d",)] * 2
    assert image["camera_response"]["origin"] == "Loaded from camera.spi1d"
    estimate(image)  # takes its place
    assert stored_estimate.has_verdict(image)
    assert stored_estimate.origin(image) == ""


def test_it_survives_saving_and_goes_to_other_plates(image, lut_file, tmp_path, codes):
    load(image, lut_file())
    other = image.copy()
    del other["camera_response"]
    bpy.ops.crf.copy_response(image=image.name, targets=[{"name": other.name, "is_clip": False, "is_chosen": True}])
    name = other.name
    image.use_fake_user = other.use_fake_user = True
    reopen(tmp_path / "saved.blend")
    image, other = bpy.data.images["plate.png"], bpy.data.images[name]
    assert not stored_estimate.has_verdict(image)
    assert not stored_estimate.has_verdict(other)
    assert stored_estimate.origin(other) == "From plate.png (Loaded from camera.spi1d)"
    assert np.array_equal(curve_of(image).brightness, curve_of(other).brightness)


def test_other_files_are_refused_and_change_nothing(image, tmp_path):
    path = tmp_path / "forward.cube"
    write_lut(path, Lut1D(np.linspace(0, 1, 256) ** 0.45))
    absent, picture = tmp_path / "absent.spi1d", tmp_path / "plate.png"
    for wrong, words in ((path, "Error"), (absent, "Error"), (picture, "Error"), ("", "No LUT file is chosen")):
        with pytest.raises(RuntimeError, match=words):
            load(image, wrong)
    assert "camera_response" not in image
