"""Exposures through the whole command, and sequences that are not to be mixed."""

import json

import numpy as np
import pytest

from crfnet.cli.arguments.parts import BAD_INPUT
from crfnet.luts.files import read_lut, write_lut
from crfnet.luts.lut1d import inverse_response_lut
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.configs import converted, loaded
from tests.helpers.folders import listed
from tests.helpers.images import read_image
from tests.helpers.plates import attributes, read_exr

CURVE = ResponseCurve.gamma(1.8)


@pytest.fixture(scope="module")
def lut_file(tmp_path_factory):
    """The inverse of another response than of the bundled photograph."""
    path = tmp_path_factory.mktemp("lut") / "known.spi1d"
    write_lut(path, inverse_response_lut(CURVE))
    return path


class TestExposure:
    def test_gray_is_at_018_everywhere(self, estimate, plate, tmp_path):
        done = estimate(plate, "--exposure", "gray")
        found = json.loads((tmp_path / "out" / "plate.json").read_text(encoding="utf-8"))["exposure"]
        lut = read_lut(tmp_path / "out" / "plate.spi1d")
        assert lut.apply(0.4614) * 2 ** found["stops"] == pytest.approx(0.18, abs=1e-5)
        assert found["gray_linear"] == pytest.approx(0.18, abs=1e-5)
        assert found["stops"] == found["gray_stops"]
        header = attributes(read_exr(tmp_path / "out" / "plate_linear.exr")[1])
        assert header["crfnet:exposure"] == pytest.approx(found["stops"], abs=1e-5)
        config = loaded(tmp_path / "out" / "config.ocio")
        gray = converted(config, "CRF plate", "scene_linear", [[0.4614] * 3])
        np.testing.assert_allclose(gray, 0.18, atol=1e-5)
        assert (
            f"\nExposure: {found['stops']:+.2f} stop. Code 118, by convention 18 % gray, is then 0.180.\n" in done.out
        )

    def test_a_picked_gray_is_at_018(self, crfnet, plate, lut_file, tmp_path):
        done = crfnet(
            *("linearize", plate, "--lut", lut_file, "--out", tmp_path / "a.exr", "--exposure", "gray=0.3", "--json")
        )
        stops = json.loads(done.out)["exposure"]["stops"]
        assert CURVE.inverse(0.3) * 2**stops == pytest.approx(0.18, abs=1e-5)

    def test_by_default_white_is_at_1_and_the_way_to_gray_is_told(self, estimate, plate, tmp_path):
        out = estimate(plate).out
        found = json.loads((tmp_path / "out" / "plate.json").read_text(encoding="utf-8"))["exposure"]
        assert found["stops"] == 0
        assert (
            f"\nExposure: +0.00 stop. Code 118, by convention 18 % gray, is then {found['gray_linear']:.3f};"
            f" --exposure gray would make it 0.18: {found['gray_stops']:+.2f} stop.\n"
        ) in out

    @pytest.mark.parametrize("word", ["white", "White", "WHITE", "0"])
    def test_white_is_the_default(self, estimate, plate, tmp_path, word):
        assert estimate(plate, "--exposure", word).code == 0
        given = read_image(tmp_path / "out" / "plate_linear.exr")
        assert estimate(plate, "--overwrite").code == 0
        np.testing.assert_array_equal(read_image(tmp_path / "out" / "plate_linear.exr"), given)

    @pytest.mark.parametrize(
        ("word", "message"),
        [
            ("gray=0", "a gray of 0 is not between 0 and 1; divide a code by 255"),
            ("gray=118", "a gray of 118 is not between 0 and 1; divide a code by 255"),
            ("gray=", "argument --exposure: invalid"),
            ("bright", "argument --exposure: invalid"),
            ("nan", "nan is not between -15 and 15 stops"),
        ],
    )
    def test_other_words_are_refused_in_one_line(self, crfnet, plate, tmp_path, word, message):
        done = crfnet("estimate", plate, "--out", tmp_path / "out", "--exposure", word)
        assert done.code == BAD_INPUT
        assert message in done.err
        assert done.err.count("\n") == 1


class TestResuming:
    @pytest.mark.parametrize(
        ("arguments", "difference"),
        [
            (("--exposure", "1"), "an exposure of +0 stops, not +1"),
            (("--exposure", "gray"), "an exposure of +0 stops, not "),
            (("--exposure", "12.304"), "an exposure of +0 stops, not +12.304"),
            (("--output-space", "ACEScg"), "the color space lin_rec709_scene, not lin_ap1_scene"),
            (("--primaries", "p3"), "the primaries Rec.709, not Display P3"),
            (("--depth", "float"), "half samples, not float"),
        ],
    )
    def test_a_sequence_is_not_mixed(self, crfnet, frames, look, arguments, difference):
        same = ("linearize", frames / "shot.####.jpg", "--lut", look / "plate.spi1d", "--out", frames / "l.####.exr")
        assert crfnet(*same, "--frames", "1-2").code == 0
        before = {name: (frames / name).read_bytes() for name in listed(frames)}
        done = crfnet(*same, *arguments)
        assert done.code == BAD_INPUT
        assert "l.0001.exr: is there already, with " + difference in done.err
        assert done.err.endswith("; repeat that or write elsewhere; or add --overwrite\n")
        assert {name: (frames / name).read_bytes() for name in listed(frames)} == before
        assert crfnet(*same, *arguments, "--overwrite").code == 0
        assert crfnet(*same, *arguments).code == 0

    def test_a_lut_in_another_format_is_the_same(self, crfnet, frames, look):
        same = ("linearize", frames / "shot.####.jpg", "--out", frames / "l.####.exr")
        assert crfnet(*same, "--lut", look / "plate.spi1d", "--frames", "1").code == 0
        assert crfnet(*same, "--lut", look / "plate.cube").code == 0
