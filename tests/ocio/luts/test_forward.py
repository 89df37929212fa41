import shutil
import subprocess

import numpy as np
import PyOpenColorIO as OCIO
import pytest

from crfnet.errors import LutError
from crfnet.luts.files import WRITERS, read_lut, write_lut
from crfnet.luts.forward import LENGTHS, forward_lut, round_trip_error
from crfnet.luts.lut1d import Lut1D, inverse_response_lut, strictly_increasing
from crfnet.luts.response import read_response, response_of_lut
from crfnet.luts.rgb_lut import RgbLut1D
from crfnet_core.posterior.responses import ResponseBank
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.configs import through_lut
from tests.helpers.refusals import refusal_of

SUFFIXES = tuple(WRITERS)
POWERS = (2.2, 1.8, 2.0)


@pytest.fixture(scope="module")
def rgb_lut():
    return RgbLut1D(tuple(inverse_response_lut(ResponseCurve.gamma(power)) for power in POWERS), ("three",))


class TestForward:
    @pytest.mark.parametrize("suffix", SUFFIXES)
    @pytest.mark.parametrize("bits", [8, 10])
    def test_gives_every_code_back_in_opencolorio(self, tmp_path, suffix, bits, true_response):
        lut = inverse_response_lut(true_response)
        write_lut(tmp_path / f"a{suffix}", lut)
        write_lut(tmp_path / f"b{suffix}", forward_lut(lut))
        codes = np.repeat(np.arange(2**bits)[:, None] / (2**bits - 1), 3, axis=1)
        back = through_lut(tmp_path / f"b{suffix}", through_lut(tmp_path / f"a{suffix}", codes))
        error = np.abs(back - codes).max() * (2**bits - 1)
        assert error < 0.1
        assert error == pytest.approx(round_trip_error(lut, forward_lut(lut), bits=bits), abs=1e-3)

    def test_1024_entries_hold_nearly_all_responses_of_the_bank(self):
        lengths = []
        for brightness in ResponseBank.load().brightness[::38]:
            lut = inverse_response_lut(ResponseCurve.from_samples(brightness))
            forward = forward_lut(lut)
            lengths.append(len(forward.values))
            assert round_trip_error(lut, forward, bits=8) < 0.05
            assert round_trip_error(lut, forward, bits=10) <= 0.1
        assert lengths.count(1024) >= 45  # of 50

    def test_a_power_function_takes_more_and_says_its_error(self):
        lut = Lut1D(strictly_increasing(np.linspace(0, 1, 4096) ** 2.2))
        forward = forward_lut(lut)
        assert len(forward.values) == LENGTHS[-1]
        errors = [round_trip_error(lut, forward, bits=bits) for bits in (8, 10)]
        assert errors[0] < 0.5 < errors[1]
        assert f"in codes, {errors[0]:.2g} of 8 bits and {errors[1]:.2g} of 10 bits" in forward.comments[1]

    def test_its_domain_is_the_light_of_the_codes(self, true_response):
        brighter = Lut1D(inverse_response_lut(true_response).values * 4)
        forward = forward_lut(brighter)
        assert forward.domain == (0, 4)
        assert round_trip_error(brighter, forward, bits=10) < 0.1
        extended = inverse_response_lut(true_response, length=5101, domain=(-0.125, 1.125))
        assert forward_lut(extended).domain == (0, 1)

    def test_it_says_its_direction_and_not_the_other(self, true_response):
        comments = ("Inverse camera response: encoded in", "Photographs: a.jpg")
        lut = inverse_response_lut(true_response, comments=comments)
        direction, _, photographs = forward_lut(lut).comments
        assert direction.startswith("Camera response: relative scene-linear irradiance in")
        assert photographs == "Photographs: a.jpg"


class TestRgbLut:
    @pytest.mark.parametrize("suffix", SUFFIXES)
    def test_opencolorio_agrees_in_both_directions(self, tmp_path, suffix, rgb_lut, tolerance):
        write_lut(tmp_path / f"a{suffix}", rgb_lut)
        assert read_lut(tmp_path / f"a{suffix}") == rgb_lut
        pixels = np.random.default_rng(2).random((500, 3))
        assert np.abs(through_lut(tmp_path / f"a{suffix}", pixels) - rgb_lut.apply(pixels)).max() < tolerance.lut
        back = through_lut(tmp_path / f"a{suffix}", pixels, OCIO.TRANSFORM_DIR_INVERSE)
        expected = [lut.apply_inverse(column) for lut, column in zip(rgb_lut.channels, pixels.T, strict=True)]
        assert np.abs(back - np.transpose(expected)).max() < tolerance.lut

    def test_each_channel_has_its_forward_table(self, rgb_lut):
        forward = forward_lut(rgb_lut)
        assert [channel.domain for channel in forward.channels] == [(0, 1)] * 3
        assert round_trip_error(rgb_lut, forward, bits=10) < 0.1

    def test_tables_that_differ_in_shape_are_refused(self):
        for channels in ((Lut1D([0, 1]), Lut1D([0, 1])), (Lut1D([0, 1]), Lut1D([0, 1]), Lut1D([0, 0.5, 1]))):
            assert refusal_of(LutError, RgbLut1D, channels).code == "lut_tables_differ"


class TestFfmpeg:
    """ffmpeg's lut1d reads our .cube: exact in float, cut down to the code below in integers."""

    def through_ffmpeg(self, path, values, pixel_format):
        if shutil.which("ffmpeg") is None:
            pytest.skip("needs ffmpeg")
        raw = ["-f", "rawvideo", "-pix_fmt", pixel_format]
        command = ["ffmpeg", "-v", "error", *raw, "-s", f"{values.size // 3}x1", "-i", "-"]
        command += ["-vf", f"lut1d=file={path.name}", *raw, "-"]
        done = subprocess.run(command, cwd=path.parent, input=values.tobytes(), capture_output=True, check=True)
        return np.frombuffer(done.stdout, dtype=values.dtype).reshape(values.shape)

    @pytest.mark.parametrize("is_forward_lut", [False, True])
    def test_in_float(self, tmp_path, true_response, is_forward_lut, tolerance):
        lut = inverse_response_lut(true_response)
        lut = forward_lut(lut) if is_forward_lut else lut
        write_lut(tmp_path / "a.cube", lut)
        planes = np.tile(np.linspace(0, 1, 4096, dtype="<f4"), (3, 1))  # G, B, R
        result = self.through_ffmpeg(tmp_path / "a.cube", planes, "gbrpf32le")
        assert np.abs(result - lut.apply(planes)).max() < tolerance.lut

    @pytest.mark.parametrize(("bits", "pixel_format", "kind"), [(8, "rgb24", "u1"), (16, "rgb48le", "<u2")])
    def test_in_integers(self, tmp_path, true_response, bits, pixel_format, kind):
        lut, most = inverse_response_lut(true_response), 2**bits - 1
        write_lut(tmp_path / "a.cube", lut)
        codes = np.repeat(np.linspace(0, most, 4096).astype(kind)[:, None], 3, axis=1)
        error = self.through_ffmpeg(tmp_path / "a.cube", codes, pixel_format) - lut.apply(codes / most) * most
        assert error.max() < 0.05
        assert error.min() > -1.01


GRID = np.linspace(0, 1, 4081)


@pytest.mark.parametrize("domain", [(0.0, 1.0), (-0.125, 1.125)])
@pytest.mark.parametrize("length", [4081, 16321])
def test_a_lut_gives_its_response_back(true_response, length, domain):
    result = response_of_lut(inverse_response_lut(true_response, length=length, domain=domain))
    assert np.abs(result.brightness - true_response.brightness).max() < 2e-4
    assert np.abs(result.inverse(GRID) - true_response.inverse(GRID)).max() < 5e-5


def test_the_scale_of_the_lut_does_not_count():
    lut = inverse_response_lut(ResponseCurve.gamma(2.2))
    scaled = response_of_lut(Lut1D(lut.values * 4))
    assert np.abs(scaled.brightness - response_of_lut(lut).brightness).max() < 1e-6


@pytest.mark.parametrize(
    ("lut", "code"),
    [
        (Lut1D(GRID ** (1 / 2.2)), "lut_brightens"),
        (Lut1D(GRID + 0.1), "lut_black_or_white"),
        (Lut1D(GRID**2.2, domain=(0.1, 1.0)), "lut_domain_short"),
        (RgbLut1D((Lut1D(GRID), Lut1D(GRID), Lut1D(GRID**2))), "lut_channels_differ"),
    ],
)
def test_other_luts_are_refused(lut, code):
    assert refusal_of(LutError, response_of_lut, lut).code == code


@pytest.mark.parametrize("suffix", WRITERS)
class TestFiles:
    def test_an_inverse_response_is_taken_as_it_is(self, tmp_path, suffix, true_response):
        lut = inverse_response_lut(true_response, comments=("mine",))
        write_lut(tmp_path / f"a{suffix}", lut)
        result = read_response(tmp_path / f"a{suffix}")
        assert (result.lut, result.table, result.was_forward) == (lut, lut, False)
        assert result.words == f"LUT of the format {suffix}, one table, from code values to light"

    def test_a_response_is_inverted(self, tmp_path, suffix, true_response):
        write_lut(tmp_path / f"a{suffix}", forward_lut(inverse_response_lut(true_response)))
        result = read_response(tmp_path / f"a{suffix}")
        assert result.was_forward
        assert np.abs(result.lut.apply(GRID) - true_response.inverse(GRID)).max() < 1e-4
        assert result.lut.comments[0].endswith("from light to code values; this is its inverse")


def test_linear_light_is_not_inverted(tmp_path):
    write_lut(tmp_path / "a.cube", Lut1D([0, 1]))
    assert not read_response(tmp_path / "a.cube").was_forward


@pytest.mark.parametrize("suffix", WRITERS)
@pytest.mark.parametrize("codes", [(0, 255), (-255, 0), (-1, 0.05), (0, 0.5), (0.5, 1), (1.5, 2)])
@pytest.mark.parametrize("forward", [False, True])
def test_a_lut_of_other_codes_than_0_to_1_is_refused(tmp_path, suffix, codes, forward):
    """Parts of a plate would be black or white."""
    low, high = codes
    lut = Lut1D(low + (high - low) * GRID ** (1 / 2.2)) if forward else Lut1D(GRID**2.2, domain=codes)
    write_lut(tmp_path / f"a{suffix}", lut)
    assert refusal_of(LutError, read_response, tmp_path / f"a{suffix}").code == "lut_of_codes"
