"""Exposures through the whole command, and sequences that are not to be mixed."""

import json

import numpy as np
import pytest

from crfnet.luts.files import read_lut, write_lut
from crfnet.luts.lut1d import inverse_response_lut
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.configs import converted, loaded
from tests.helpers.folders import tree
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
        assert estimate(plate, "--exposure", "gray").code == 0
        found = json.loads((tmp_path / "out" / "plate.json").read_text(encoding="utf-8"))["exposure"]
        lut = read_lut(tmp_path / "out" / "plate.spi1d")
        assert lut.apply(0.4614) * 2 ** found["stops"] == pytest.approx(0.18, abs=1e-5)
        assert found["gray_linear"] == pytest.approx(0.18, abs=1e-5)
        assert found["stops"] == found["gray_stops"]
        header = attributes(read_exr(tmp_path / "out" / "plate_linear.exr")[1])
        assert header["crfnet:exposure"] == pytest.approx(found["stops"], abs=1e-5)
        gray = converted(loaded(tmp_path / "out" / "config.ocio"), "CRF plate", "scene_linear", [[0.4614] * 3])
        np.testing.assert_allclose(gray, 0.18, atol=1e-5)

    def test_a_picked_gray_is_at_018(self, crfnet, plate, lut_file, tmp_path):
        chosen = ("--lut", lut_file, "--exposure", "gray=0.3", "--json")
        done = crfnet("linearize", plate, "--out", tmp_path / "a.exr", *chosen)
        stops = json.loads(done.out)["exposure"]["stops"]
        assert CURVE.inverse(0.3) * 2**stops == pytest.approx(0.18, abs=1e-5)

    @pytest.mark.parametrize("word", ["White", "0"])
    def test_white_at_1_is_the_default_and_the_way_to_gray_is_shown(self, estimate, plate, tmp_path, word):
        assert estimate(plate, "--exposure", word).code == 0
        given = read_image(tmp_path / "out" / "plate_linear.exr")
        out = estimate(plate, "--overwrite").out
        np.testing.assert_array_equal(read_image(tmp_path / "out" / "plate_linear.exr"), given)
        found = json.loads((tmp_path / "out" / "plate.json").read_text(encoding="utf-8"))["exposure"]
        assert found["stops"] == 0
        assert f"(18 % gray by convention) at {found['gray_linear']:.3f}; --exposure gray puts it at 0.18" in out

    @pytest.mark.parametrize(
        ("word", "words"),
        [("gray=0", "a gray of 0"), ("gray=118", "a gray of 118"), ("gray=", ""), ("bright", ""), ("nan", "nan is")],
    )
    def test_other_words_are_refused(self, crfnet, plate, tmp_path, word, words):
        done = crfnet("estimate", plate, "--out", tmp_path / "out", "--exposure", word)
        assert (done.refusal, f"argument --exposure: {words}" in done.err) == ("usage", True)


class TestResuming:
    @pytest.mark.parametrize(
        ("arguments", "difference"),
        [
            (("--exposure", "1"), "an exposure of +0 stops, not +1"),
            (("--exposure", "12.304"), "an exposure of +0 stops, not +12.304"),
            (("--output-space", "ACEScg"), "the color space lin_rec709_scene, not lin_ap1_scene"),
            (("--primaries", "p3"), "the primaries Rec.709, not Display P3"),
            (("--depth", "float"), "half samples, not float"),
        ],
    )
    def test_a_sequence_is_not_mixed(self, crfnet, frames, look, arguments, difference):
        same = ("linearize", frames / "shot.####.jpg", "--lut", look / "plate.spi1d", "--out", frames / "l.####.exr")
        assert crfnet(*same, "--frames", "1-2").code == 0
        before = tree(frames)
        done = crfnet(*same, *arguments)
        assert (done.refusal, difference in done.err) == ("finished_differs", True)
        assert done.err.endswith("; or add --overwrite\n")
        assert tree(frames) == before
        assert crfnet(*same, *arguments, "--overwrite").code == 0
        assert crfnet(*same, *arguments).code == 0
