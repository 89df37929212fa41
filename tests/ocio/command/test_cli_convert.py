"""`crfnet convert`, and the commands that take a response from another program."""

import json

import numpy as np
import pytest

from crfnet.interchange.files import read_response, write_response
from crfnet.luts.files import WRITERS, read_lut, write_lut
from crfnet.luts.forward import forward_lut
from crfnet.luts.lut1d import inverse_response_lut
from crfnet.luts.rgb_lut import RgbLut1D
from tests.helpers.images import read_image


@pytest.fixture
def lut_file(tmp_path, true_response):
    path = tmp_path / "plate01.spi1d"
    write_lut(path, inverse_response_lut(true_response))
    return path


@pytest.fixture
def rgb_file(tmp_path, true_response):
    """OpenCV's file of a response whose channels differ."""
    lut = inverse_response_lut(true_response, length=256)
    channels = [type(lut)(lut.values**power) for power in (1.1, 1.0, 0.9)]
    write_response(tmp_path / "camera.npy", RgbLut1D(tuple(channels)))
    return tmp_path / "camera.npy"


class TestConvert:
    @pytest.mark.parametrize("suffix", [".npy", ".yml", ".xml", ".m", ".txt", ".cube", ".clf"])
    def test_there_and_back(self, crfnet, tmp_path, lut_file, suffix, true_response):
        done = crfnet("convert", lut_file, tmp_path / f"a{suffix}")
        assert (done.code, done.err) == (0, "")
        assert (
            done.out.splitlines()[0] == "plate01.spi1d: LUT of the format .spi1d, one table, from code values to light."
        )
        assert done.out.splitlines()[-1] == f"Written: {tmp_path / f'a{suffix}'}."
        assert crfnet("convert", tmp_path / f"a{suffix}", tmp_path / "back.spi1d").code == 0
        codes = np.arange(1, 256) / 255
        assert np.abs(read_lut(tmp_path / "back.spi1d").apply(codes) - true_response.inverse(codes)).max() < 1e-4

    def test_forward(self, crfnet, tmp_path, lut_file):
        done = crfnet("convert", lut_file, tmp_path / "a.cube", "--forward")
        assert done.code == 0
        assert "Gives every code back from its linear light within, in codes, 0.0" in done.out
        assert read_lut(tmp_path / "a.cube").values == pytest.approx(forward_lut(read_lut(lut_file)).values)

    def test_as_json(self, crfnet, tmp_path, rgb_file):
        document = json.loads(crfnet("convert", rgb_file, tmp_path / "a.clf", "--json").out)
        assert document["written"] == str(tmp_path / "a.clf")
        assert document["notes"][1:] == ["Scaled so that white, of green, is 1"]

    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            (["plate01.spi1d", "a.npy", "--forward"], "--forward is for LUTs"),
            (["plate01.spi1d", "a.csp"], "responses are written as .spi1d, .cube, .clf, .npy"),
            (["plate01.spi1d", "none.pto"], "there is no such project; save one in Hugin first"),
            (["none.m", "a.cube"], "cannot be read (No such file or directory)"),
            (["plate01.spi1d", "plate01.spi1d"], "exists already"),
        ],
    )
    def test_refusals_leave_nothing(self, crfnet, tmp_path, lut_file, monkeypatch, arguments, message):
        monkeypatch.chdir(tmp_path)
        before = lut_file.read_bytes()
        done = crfnet("convert", *arguments)
        assert (done.code, done.out) == (2, "")
        assert message in done.err
        assert [path.name for path in tmp_path.iterdir()] == ["plate01.spi1d"]
        assert lut_file.read_bytes() == before


class TestLinearize:
    def test_through_a_response_of_opencv(self, crfnet, tmp_path, rgb_file, plate_file, codes, tolerance):
        done = crfnet("linearize", plate_file, "--lut", rgb_file, "--out", tmp_path / "a.exr", "--depth", "float")
        assert done.code == 0
        assert done.out.startswith("camera.npy: OpenCV response (channels B, G, R), R, G and B apart, from code values")
        expected = read_response(rgb_file).lut.apply(codes / 255)
        assert np.abs(read_image(tmp_path / "a.exr") - expected).max() < tolerance.plate

    @pytest.mark.parametrize("suffix", WRITERS)
    def test_through_a_response_from_light_to_codes(self, crfnet, tmp_path, lut_file, plate_file, suffix):
        forward = tmp_path / f"forward{suffix}"
        assert crfnet("convert", lut_file, forward, "--forward").code == 0
        done = crfnet("linearize", plate_file, "--lut", forward, "--out", tmp_path / "a.exr", "--depth", "float")
        assert "one table, from light to code values; its inverse is used." in done.out
        crfnet("linearize", plate_file, "--lut", lut_file, "--out", tmp_path / "b.exr", "--depth", "float")
        assert np.abs(read_image(tmp_path / "a.exr") - read_image(tmp_path / "b.exr")).max() < 1e-4

    def test_an_inverse_response_needs_no_words(self, crfnet, tmp_path, lut_file, plate_file):
        done = crfnet("linearize", plate_file, "--lut", lut_file, "--out", tmp_path / "a.exr")
        assert done.code == 0
        assert "plate01.spi1d" not in done.out


class TestInfo:
    def test_of_three_channels(self, crfnet, rgb_file):
        first, second, third, scaled = crfnet("info", rgb_file).out.splitlines()
        assert first == "camera.npy: 1D LUT of 256 entries, strictly increasing"
        assert second.startswith("  brightness 0 to 1 becomes irradiance 0.00")
        assert third == "  OpenCV response (channels B, G, R), R, G and B apart, from code values to light"
        assert scaled == "  Scaled so that white, of green, is 1"

    def test_of_a_response_from_light_to_codes(self, crfnet, tmp_path, lut_file):
        crfnet("convert", lut_file, tmp_path / "a.clf", "--forward")
        assert "  irradiance 0 to 1 becomes brightness 0 to 1; " in crfnet("info", tmp_path / "a.clf").out
        document = json.loads(crfnet("info", tmp_path / "a.clf", "--json").out)
        assert (document["direction"], document["channels"]) == ("forward", 1)
        assert document["converts"] == ["irradiance", "brightness"]


class TestEstimate:
    def test_forward_writes_the_response_too(self, estimate, tmp_path, plate):
        done = estimate(plate, "--forward")
        assert (done.code, done.err) == (0, "")
        document = json.loads((tmp_path / "out" / "plate.json").read_text())
        assert document["files"]["forward"] == [f"plate_forward{suffix}" for suffix in WRITERS]
        tables = [read_lut(tmp_path / "out" / name) for name in document["files"]["forward"]]
        assert tables[0].values == pytest.approx(document["response"]["brightness"], abs=1e-3)
        assert all(np.array_equal(table.values, tables[0].values) for table in tables)
        assert "response as a LUT: light in, code values out" in done.out

    def test_without_it_no_such_file_is_written(self, estimate, tmp_path, plate):
        assert estimate(plate).code == 0
        assert not list((tmp_path / "out").glob("*_forward*"))
