"""The LUT and the config through the real oiiotool give what `crfnet linearize` gives."""

import numpy as np
import pytest

from tests.helpers.images import read_image


def test_linearize_equals_the_plate_of_estimate(linear, look):
    np.testing.assert_array_equal(linear, read_image(look / "plate_linear.exr"))


@pytest.mark.parametrize("suffix", ["spi1d", "cube", "clf"])
def test_oiiotool_with_the_lut(linear, look, plate, oiiotool, tolerance, tmp_path, suffix):
    out = tmp_path / "out.exr"
    oiiotool(plate, "--ociofiletransform", look / f"plate.{suffix}", "-d", "float", "-o", out)
    np.testing.assert_allclose(read_image(out), linear, atol=tolerance.plate)


@pytest.mark.parametrize(
    ("rule", "convert"), [((), ("--colorconvert", "CRF plate", "scene_linear")), (("--autocc",), ())]
)
def test_oiiotool_with_the_config_and_with_its_file_rule(
    linear, look, plate, oiiotool, tolerance, tmp_path, rule, convert
):
    out = tmp_path / "out.exr"
    oiiotool("--colorconfig", look / "config.ocio", *rule, plate, *convert, "-d", "float", "-o", out)
    np.testing.assert_allclose(read_image(out), linear, atol=tolerance.plate)
