"""Plates that are logarithmic or linear are refused, by colour space and by metadata."""

import dataclasses

import pytest

from blender_addon.work.encoding_check import check_is_encoded, is_log_or_linear
from blender_addon.work.errors import AddonError
from tests.helpers.images import write_image


@pytest.mark.parametrize(
    "name",
    ["Linear Rec.709", "lin_rec709", "ACEScg", "ACES2065-1", "ADX10", "Filmic Log", "AgX Log", "ARRI LogC4", "S-Log3"],
)
def test_names_of_log_and_linear_spaces(name):
    assert is_log_or_linear(name)


@pytest.mark.parametrize("name", ["sRGB", "Non-Color", "Display P3", "Rec.1886", "Rec.2020", "CRF plate", "Gamma 2.2"])
def test_names_of_other_spaces(name):
    assert not is_log_or_linear(name)


@pytest.mark.parametrize(
    ("encoding", "expected"),
    [("log", True), ("scene-linear", True), ("display-linear", True), ("sdr-video", False), ("data", False)],
)
def test_the_configs_encoding_counts_for_more_than_the_name(encoding, expected):
    assert is_log_or_linear("Linear", encoding) is expected
    assert is_log_or_linear("sRGB", encoding) is expected


@pytest.fixture
def check(make_job, running_config, plate_file):
    """Check a file, taken for one of a colour space of the running config."""

    def run(color_space="sRGB", path=plate_file, config=running_config):
        plate = dataclasses.replace(make_job(path).plate, color_space=color_space)
        check_is_encoded(plate, path, str(config))

    return run


def test_a_space_that_the_config_calls_linear_is_refused(check):
    with pytest.raises(
        AddonError, match=r"^plate: its color space, scene_linear, .* tick Estimate Anyway under Advanced$"
    ):
        check("scene_linear")


def test_an_encoded_photograph_passes(check):
    check("sRGB")
    check("a space that no config has")


def test_without_a_readable_config_the_name_decides(check, tmp_path):
    check("sRGB", config=tmp_path / "none.ocio")
    with pytest.raises(AddonError, match="ACEScg"):
        check("ACEScg", config=tmp_path / "none.ocio")


@pytest.mark.parametrize("transfer", ["Logarithmic", "Linear", "Printing density"])
def test_a_dpx_that_calls_itself_log_or_linear_is_refused(check, tmp_path, codes, transfer):
    path = write_image(tmp_path / "scan.dpx", codes, dpx__Transfer=transfer)
    with pytest.raises(AddonError, match=r"scan\.dpx: calls itself"):
        check("sRGB", path)


def test_blenders_guess_that_every_dpx_is_linear_does_not_count(check, tmp_path, codes):
    check("Linear Rec.709", write_image(tmp_path / "video.dpx", codes))


def test_a_file_that_cannot_be_read_is_not_judged(check, plate_file):
    plate_file.write_bytes(b"no picture")
    check("sRGB")
