"""Plates that are logarithmic or linear are refused, by color space and by metadata."""

import numpy as np
import pytest

from blender_addon.work.encoding_check import check_is_encoded, is_log_or_linear
from blender_addon.work.errors import AddonError
from blender_addon.work.estimate_record import loaded_estimate
from blender_addon.work.job import ApplyMode
from blender_addon.work.run import run
from crfnet_core.colorimetry import REC2020
from crfnet_core.errors import PhotoError
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.images import read_image, write_image
from tests.helpers.refusals import refused

#: A response that is loaded from a LUT file.
CURVE = ResponseCurve.gamma(2.2)


def test_names_of_log_and_linear_spaces():
    names = ["Linear Rec.709", "lin_rec709", "ACEScg", "ACES2065-1", "ADX10", "AgX Log", "ARRI LogC4", "S-Log3"]
    assert [name for name in names if not is_log_or_linear(name)] == []
    others = ["sRGB", "Non-Color", "Display P3", "Rec.1886", "Rec.2020", "CRF plate", "Gamma 2.2"]
    assert [name for name in others if is_log_or_linear(name)] == []


@pytest.mark.parametrize(
    ("encoding", "expected"),
    [("log", True), ("scene-linear", True), ("display-linear", True), ("sdr-video", False), ("data", False)],
)
def test_the_configs_encoding_counts_for_more_than_the_name(encoding, expected):
    assert is_log_or_linear("Linear", encoding) is expected
    assert is_log_or_linear("sRGB", encoding) is expected


@pytest.fixture
def check(make_job, running_config, plate_file):
    """Check a plate of a color space, by the running config or another one."""

    def run(color_space, config=running_config):
        check_is_encoded(make_job(color_space=color_space).plate, plate_file, str(config))

    return run


def test_a_space_that_the_config_calls_linear_is_refused(check):
    with pytest.raises(AddonError, match=r"scene_linear, .* tick Estimate Anyway under Advanced$"):
        check("scene_linear")


def test_without_a_readable_config_the_name_decides(check, tmp_path):
    check("sRGB", config=tmp_path / "none.ocio")
    with pytest.raises(AddonError, match="ACEScg"):
        check("ACEScg", config=tmp_path / "none.ocio")


@pytest.fixture
def tagged(tmp_path, codes):
    """A file that the estimator refuses for its metadata."""
    return write_image(tmp_path / "scan.dpx", codes, dpx__Transfer="Logarithmic")


def test_a_file_that_calls_itself_log_is_refused(make_job, tagged):
    with refused(PhotoError, "tagged_encoding", path=tagged):
        run(make_job(tagged, mode=ApplyMode.ESTIMATE))


def test_estimate_anyway_overrules_the_tag(make_job, tagged):
    found = run(make_job(tagged, mode=ApplyMode.ESTIMATE, is_forced=True)).estimate
    assert found.origins == ()
    assert found.weights.shape == (11,)


def test_estimate_anyway_leaves_the_metadata_of_other_files_alone(make_job):
    assert len(run(make_job(mode=ApplyMode.ESTIMATE, is_forced=True)).estimate.origins) == 1


@pytest.fixture
def untagged(tmp_path, codes):
    return write_image(tmp_path / "plate.exr", (codes / 255).astype(np.float32))


def loaded(make_job, path, **choices):
    """The job of a plate with a response from a LUT file."""
    return make_job(path, stored=loaded_estimate(CURVE, "loaded from camera.cube"), **choices)


def test_an_exr_that_the_user_calls_encoded_is_baked(make_job, untagged, codes):
    baked = run(loaded(make_job, untagged, color_space="lin_rec709_scene", is_forced=True))
    assert np.abs(read_image(baked.files.files[0]) - CURVE.inverse(codes / 255)).max() < 1e-5


def test_the_primaries_of_such_an_exr_are_those_of_its_tags(make_job, tmp_path, codes):
    corners = (0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329)
    path = write_image(tmp_path / "wide.exr", (codes / 255).astype(np.float32), chromaticities=("float[8]", corners))
    assert run(loaded(make_job, path)).primaries == REC2020


def test_an_exr_of_which_nothing_is_said_is_refused_with_what_to_do_in_blender(make_job, untagged):
    with pytest.raises(AddonError, match="choose its color space in Blender, or tick Estimate Anyway under Advanced"):
        run(loaded(make_job, untagged, color_space="lin_rec709_scene"))
