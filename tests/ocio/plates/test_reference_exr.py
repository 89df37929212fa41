"""OpenEXR, the reference library, reads what the command writes: pixels, header, chunk table, compression."""

import numpy as np
import OpenImageIO as oiio
import pytest

from crfnet.errors import PlateError
from crfnet.luts.lut1d import Lut1D
from crfnet.plates import exr
from crfnet.plates.frame_files import read_frame
from tests.helpers.images import write_image
from tests.helpers.plates import linearize
from tests.helpers.reference_exr import OpenEXR, read_reference
from tests.helpers.refusals import refusal_of


@pytest.mark.parametrize(("depth", "sample"), [("half", np.float16), ("float", np.float32)])
def test_the_pixels_are_the_entries_of_the_lut(tmp_path, depth, sample):
    codes = np.random.default_rng(0).integers(0, 256, (61, 47, 3), dtype=np.uint8)
    plate, out = write_image(tmp_path / "plate.png", codes), tmp_path / "linear.exr"
    linearize(plate, out, Lut1D(np.linspace(0, 1, 4081) ** 2), depth=depth)
    header, pixels = read_reference(out)
    assert pixels.dtype == sample
    np.testing.assert_array_equal(pixels, ((codes / 255.0) ** 2).astype(np.float32).astype(sample))
    assert header["compression"] == OpenEXR.ZIPS_COMPRESSION


def test_alpha_of_whole_numbers_is_refused(tmp_path):
    """It holds the numbers of objects, not coverage."""
    picture = {"RGB": np.full((4, 5, 3), 0.5, np.float32), "A": np.ones((4, 5), np.uint32)}
    OpenEXR.File({"type": OpenEXR.scanlineimage}, picture).write(str(tmp_path / "a.exr"))
    assert refusal_of(PlateError, read_frame, tmp_path / "a.exr", is_encoded=True).code == "exr_channels"


@pytest.mark.parametrize("width", [90, 8000])  # rows of less and of more than a page of memory
@pytest.mark.parametrize("damage", ["half", "byte", "table", "page", "gap", "header", "all"])
def test_a_file_of_which_a_part_is_lost_is_known_without_reading_its_pixels(tmp_path, width, damage):
    path, height = tmp_path / "a.exr", 40
    pixels = (np.random.default_rng(0).integers(0, 256, (height, width, 3)) / 256).astype(np.float16)
    spec = oiio.ImageSpec(width, height, 3, "half")
    spec.attribute("compression", "zips")
    spec.y = -3
    exr.write_exr(path, spec, pixels, name=path)
    np.testing.assert_array_equal(read_reference(path)[1], pixels)
    content = path.read_bytes()
    middle, page = len(content) // 2, 4096
    table = content.index(spec.y.to_bytes(4, "little", signed=True), 400) - 8 * height  # before the first chunk
    damaged = {
        "half": content[:middle],
        "byte": content[:-1],
        "table": content[:table] + bytes(8 * height) + content[table + 8 * height :],
        "page": content[:-page] + bytes(page),
        "gap": content[:middle] + content[middle + page :],
        "header": content[: table - 20],
        "all": b"",
    }
    path.write_bytes(damaged[damage])
    assert not exr.is_whole(path, spec)
    if damage == "table":  # OpenEXR rebuilds one of zeros
        return
    with pytest.raises((AssertionError, OSError, RuntimeError, ValueError)):
        read_reference(path)
