from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from crfnet_core import AnalysisOptions, Photo, ResponseNetwork, estimate_response, read_photo
from crfnet_core.errors import PhotoError
from crfnet_core.photograph.metadata import Encoding, file_origin
from crfnet_core.photograph.recognition import Kind
from crfnet_core.posterior import Family, Verdict
from tests.helpers.footage import log_picture, ordinary_picture, quantized
from tests.helpers.images import write_image


@pytest.fixture(scope="module")
def network():
    return ResponseNetwork.load()


def estimated(pixels, network, name="picture.png"):
    photo = Photo(pixels=pixels, bit_depth=8, is_gray=False, path=Path(name))
    return estimate_response(photo, network=network, options=AnalysisOptions(windows=4))


@pytest.mark.parametrize("name", ["ARRI LogC3", "Canon Log", "Panasonic V-Log", "Sony S-Log3"])
def test_log_footage_is_not_to_be_trusted(network, name):
    estimate = estimated(log_picture(name), network)
    assert estimate.verdict is Verdict.DO_NOT_TRUST
    assert estimate.recognition.kind is Kind.LOG_FOOTAGE
    assert estimate.families[Family.LOG] > 0.5
    assert estimate.warnings[0].code == "recognized"


def test_limited_range_is_not_to_be_trusted_and_says_what_to_do(network, plate):
    pixels = read_photo(plate).pixels
    limited = quantized((16 + 219 * np.clip(pixels.astype(float) * 1.05 - 0.02, 0, 1)) / 255)
    estimate = estimated(limited, network)
    assert (estimate.verdict, estimate.recognition.kind) == (Verdict.DO_NOT_TRUST, Kind.LIMITED_RANGE)


def test_ordinary_pictures_are_left_alone(network, plate):
    for pixels in (read_photo(plate).pixels, ordinary_picture()):
        estimate = estimated(pixels, network)
        assert estimate.recognition is None
        assert estimate.families[Family.LOG] < 0.5


@pytest.mark.parametrize(
    ("name", "attributes", "code"),
    [
        ("a.dpx", {"dpx__Transfer": "Printing density"}, "tagged_encoding"),
        ("a.dpx", {"dpx__Transfer": "Logarithmic"}, "tagged_encoding"),
        ("a.png", {"CICP": (oiio.TypeDesc("int[4]"), (9, 16, 0, 1))}, "tagged_color_space"),
        ("a.png", {"CICP": (oiio.TypeDesc("int[4]"), (9, 18, 0, 1))}, "tagged_color_space"),
    ],
)
def test_a_tag_of_a_published_curve_ends_the_estimate_unless_metadata_is_ignored(
    tmp_path, fixed_model, name, attributes, code
):
    codes = np.rint(ordinary_picture() * 255).astype(np.uint8)
    photo, network = read_photo(write_image(tmp_path / name, codes, **attributes)), ResponseNetwork.load(fixed_model)
    with pytest.raises(PhotoError) as caught:
        estimate_response(photo, network=network)
    assert caught.value.code == code
    assert estimate_response(photo, network=network, options=AnalysisOptions(use_metadata=False)).photos == (name,)


def test_the_linear_that_programs_write_into_every_dpx_is_not_believed(tmp_path):
    codes = np.rint(ordinary_picture() * 255).astype(np.uint8)
    photo = read_photo(write_image(tmp_path / "a.dpx", codes, dpx__Transfer="Linear"))
    assert photo.metadata.color.transfer == ""
    assert file_origin(photo.metadata).encoding is Encoding.FOOTAGE
