import json

import numpy as np
import pytest

from crfnet.luts.files import read_lut, write_lut
from crfnet.luts.forward import forward_lut
from tests.helpers.images import read_image, write_image


def test_estimates_one_response_without_a_lut(crfnet, fixed_model, frames):
    out = frames / "linear"
    done = crfnet("linearize", frames / "shot.####.jpg", "--out", out / "l.%04d.exr", "--model", fixed_model)
    assert done.code == 0
    assert "Response estimated from shot.0001.jpg and 3 more frames." in done.out
    assert all(words in done.out for words in ("\nPrior: camera; metadata: ", "4 frames", "Missing frames: 4."))
    np.testing.assert_array_equal(*[read_image(out / f"l.{number:04d}.exr") for number in (1, 5)])


def test_goes_on_where_it_stopped(crfnet, look, frames):
    arguments = ("linearize", frames / "shot.####.jpg", "--lut", look / "plate.spi1d", "--json")
    out = ("--out", frames / "l.####.exr")
    crfnet(*arguments, *out, "--frames", "1-2")
    document = json.loads(crfnet(*arguments, *out).out)
    assert document["skipped"] == [str(frames / f"l.000{number}.exr") for number in (1, 2)]
    assert document["written"] == [str(frames / f"l.000{number}.exr") for number in (3, 5)]
    assert document["missing"] == [4]
    assert document["estimate"] is None


def test_says_what_was_left_alone(crfnet, look, plate, tmp_path):
    arguments = ("linearize", plate, "--lut", look / "plate.spi1d", "--out", tmp_path / "a.exr")
    crfnet(*arguments)
    assert "left alone (--overwrite replaces them)" in crfnet(*arguments).out
    *light, written = crfnet(*arguments, "--overwrite").out.splitlines()
    assert written == f"Written: {tmp_path / 'a.exr'}."
    assert [line.partition(":")[0] for line in light] == ["Primaries", "Exposure"]


def test_an_exr_is_linearized_as_encoded_if_the_user_says_so_and_what_the_lut_clips_is_said(crfnet, look, tmp_path):
    values = np.full((4, 4, 3), 0.5, np.float32)
    values[0], values[1, 0] = 1.5, -1
    plate = write_image(tmp_path / "plate.exr", values)
    write_image(tmp_path / "inside.exr", values.clip(0, 1))
    arguments = ("--lut", look / "plate.spi1d", "--encoded", "--out")
    out = crfnet("linearize", plate, *arguments, tmp_path / "a.exr").printed
    assert "Warning: 31 % of the values are outside the LUT" in out
    assert read_image(tmp_path / "a.exr")[1:].max() < 0.5
    document = json.loads(crfnet("linearize", plate, *arguments, tmp_path / "b.exr", "--json").out)
    assert document["clipped"] == 15 / 48
    assert "31 % of the values" in crfnet("linearize", plate, *arguments, tmp_path / "each", "--each").out
    assert "values" not in crfnet("linearize", tmp_path / "inside.exr", *arguments, tmp_path / "c.exr").out


def test_frames_of_different_sizes_are_warned_of(crfnet, look, tmp_path):
    for number, shape in enumerate([(4, 6, 3), (4, 6, 3), (6, 4, 3)]):
        write_image(tmp_path / f"a.{number}.png", np.zeros(shape, np.uint8))
    for frames, is_so in (("0-1", False), ("1-2", True)):
        arguments = ("--lut", look / "plate.spi1d", "--frames", frames, "--overwrite", "--out", tmp_path / "a.%d.exr")
        out = crfnet("linearize", tmp_path / "a.%d.png", *arguments).out
        assert ("Warning: the frames have different sizes: 4 x 6, 6 x 4." in out) is is_so


def test_a_lut_from_light_to_codes_is_inverted(crfnet, look, plate, tmp_path):
    forward = tmp_path / "forward.cube"
    write_lut(forward, forward_lut(read_lut(look / "plate.spi1d")))
    arguments = ("linearize", plate, "--depth", "float", "--out")
    done = crfnet(*arguments, tmp_path / "a.exr", "--lut", forward)
    assert "from light to code values; its inverse is used." in done.out
    assert "plate.spi1d" not in crfnet(*arguments, tmp_path / "b.exr", "--lut", look / "plate.spi1d").out
    assert np.abs(read_image(tmp_path / "a.exr") - read_image(tmp_path / "b.exr")).max() < 1e-4
    document = json.loads(crfnet("info", forward, "--json").out)
    assert (document["direction"], document["converts"]) == ("forward", ["irradiance", "brightness"])


@pytest.mark.parametrize(
    ("rule", "convert"), [((), ("--colorconvert", "CRF plate", "scene_linear")), (("--autocc",), ())]
)
def test_oiiotool_with_the_config_and_with_its_file_rule(
    linear, look, plate, oiiotool, tolerance, tmp_path, rule, convert
):
    out = tmp_path / "out.exr"
    oiiotool("--colorconfig", look / "config.ocio", *rule, plate, *convert, "-d", "float", "-o", out)
    np.testing.assert_allclose(read_image(out), linear, atol=tolerance.plate)
