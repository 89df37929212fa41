"""OpenEXR, the reference library, reads what the command writes: pixels, header, chunk table, compression."""

import numpy as np
import OpenImageIO as oiio
import pytest

from crfnet.cli.main import main
from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import Lut1D
from tests.helpers.reference_exr import OpenEXR, read_reference


@pytest.fixture
def lut(tmp_path):
    path = tmp_path / "square.spi1d"
    write_lut(path, Lut1D(np.linspace(0, 1, 4081) ** 2))
    return path


def write_plate(path, pixels):
    """Write 8-bit codes as PNG, with straight alpha."""
    header = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], "uint8")
    header.attribute("oiio:UnassociatedAlpha", 1)
    output = oiio.ImageOutput.create(str(path))
    output.open(str(path), header)
    output.write_image(pixels)
    output.close()


@pytest.mark.parametrize(("depth", "sample"), [("half", np.float16), ("float", np.float32)])
def test_the_pixels_are_those_of_the_lut(lut, tmp_path, depth, sample):
    codes = np.random.default_rng(0).integers(0, 256, (61, 47, 3), dtype=np.uint8)
    write_plate(tmp_path / "plate.png", codes)
    main(
        [
            "linearize",
            str(tmp_path / "plate.png"),
            "--lut",
            str(lut),
            "--out",
            str(tmp_path / "l.exr"),
            "--depth",
            depth,
        ]
    )
    header, pixels = read_reference(tmp_path / "l.exr")
    assert pixels.dtype == sample
    np.testing.assert_array_equal(pixels, ((codes / 255.0) ** 2).astype(np.float32).astype(sample))
    assert header["compression"] == OpenEXR.ZIPS_COMPRESSION


def test_alpha_is_multiplied_once(lut, tmp_path):
    codes = np.full((4, 5, 4), 128, dtype=np.uint8)
    write_plate(tmp_path / "plate.png", codes)
    main(["linearize", str(tmp_path / "plate.png"), "--lut", str(lut), "--out", str(tmp_path / "l.exr")])
    _, pixels = read_reference(tmp_path / "l.exr")
    alpha = 128 / 255
    np.testing.assert_allclose(pixels[..., :3], alpha**3, rtol=1e-3)
    np.testing.assert_allclose(pixels[..., 3], alpha, rtol=1e-3)


def test_the_header_names_the_space_of_the_light(lut, tmp_path):
    write_plate(tmp_path / "plate.png", np.zeros((4, 5, 3), dtype=np.uint8))
    options = ["--lut", str(lut), "--out", str(tmp_path / "l.exr"), "--output-space", "ACEScg"]
    main(["linearize", str(tmp_path / "plate.png"), *options])
    header, _ = read_reference(tmp_path / "l.exr")
    assert header["colorInteropID"] == "lin_ap1_scene"
    assert header["dataWindow"][1].tolist() == [4, 3]


def test_a_file_that_was_cut_is_found_out(lut, tmp_path):
    """Such as on a full disk: so the judge can fail."""
    write_plate(tmp_path / "plate.png", np.zeros((4, 5, 3), dtype=np.uint8))
    main(["linearize", str(tmp_path / "plate.png"), "--lut", str(lut), "--out", str(tmp_path / "l.exr")])
    content = (tmp_path / "l.exr").read_bytes()
    (tmp_path / "l.exr").write_bytes(content[:-16])
    with pytest.raises((AssertionError, OSError, RuntimeError, ValueError)):
        read_reference(tmp_path / "l.exr")
