from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from PIL import Image, ImageDraw

from crfnet_core import AnalysisOptions, Photo, ResponseNetwork, estimate_response, read_photo
from crfnet_core.photograph.metadata import Device, Encoding, FileMetadata, file_origin
from crfnet_core.photograph.recognition import Kind
from crfnet_core.posterior import Family, Prior, Verdict
from crfnet_core.response.curve import UNIFORM, ResponseCurve
from crfnet_core.response.metrics import shape_error
from crfnet_core.response.transfer_functions import srgb_encode
from tests.helpers.footage import blurred, log_picture, ordinary_picture, quantized, write_picture


@pytest.fixture(scope="module")
def network():
    return ResponseNetwork.load()


def estimated(pixels, network, name="picture.png", metadata=None, **options):
    photo = Photo(pixels=pixels, bit_depth=8, is_gray=False, path=Path(name), metadata=metadata)
    return estimate_response(photo, network=network, options=AnalysisOptions(windows=4, **options))


def rendered(root, encode):
    """A render of a studio light in a plain encoding, 8 bits, whose file states only its size."""
    light = np.asarray(oiio.ImageBuf(str(root / "tests/data/lights/city.exr")).get_pixels(oiio.FLOAT))[51:461, :, :3]
    pixels = quantized(encode(np.clip(light / np.percentile(light, 95), 0, 1)))
    return {"pixels": pixels, "metadata": FileMetadata(width=1024, height=410, file_format="PNG")}


def screenshot():
    """Windows with words, and a gradient."""
    image = Image.new("RGB", (960, 640), (245, 245, 247))
    draw = ImageDraw.Draw(image)
    for row in range(36):
        draw.text((20, 18 * row), "file edit view render output compositor frame exposure " * 3, (30, 30, 30))
    draw.rectangle((500, 60, 900, 300), (40, 90, 160), (0, 0, 0))
    image.paste(Image.linear_gradient("L").resize((300, 200)).convert("RGB"), (560, 380))
    return np.asarray(image, np.float32) / np.float32(255)


def noise(kind):
    """Gray, colored or blurred noise: a frame without a scene."""
    drawn = np.random.default_rng(0).normal(0.5, 0.2, (480, 640, 1 if kind == "gray" else 3))
    for _ in range(8 if kind == "blurred" else 0):
        drawn = 0.5 + 1.4 * (blurred(drawn) - 0.5)
    return quantized(np.broadcast_to(drawn, (480, 640, 3)))


@pytest.mark.parametrize("name", ["ARRI LogC3", "Canon Log", "Panasonic V-Log", "Sony S-Log3"])
def test_log_footage_is_not_to_be_trusted(network, name):
    estimate = estimated(log_picture(name), network)
    assert estimate.verdict is Verdict.DO_NOT_TRUST
    assert estimate.recognition.kind is Kind.LOG_FOOTAGE
    assert estimate.families[Family.LOG] > 0.5
    assert estimate.warnings[0].code == "recognized"


@pytest.mark.parametrize(("file_format", "is_log"), [("JPEG", False), ("movie", True)])
def test_a_phone_writes_log_into_movies_only_and_its_hazy_stills_are_trusted(network, root, file_format, is_log):
    haze = rendered(root, lambda light: srgb_encode(0.05 + 0.7 * light))["pixels"]
    phone = FileMetadata(make="samsung", model="SM-A528B", width=480, height=480, file_format=file_format)
    estimate = estimated(haze, network, metadata=phone)
    assert bool(estimate.recognition) is is_log
    assert (estimate.verdict is Verdict.USABLE) is not is_log


def test_limited_range_is_not_to_be_trusted_and_says_what_to_do(network, plate):
    pixels = read_photo(plate).pixels
    limited = quantized((16 + 219 * np.clip(pixels.astype(float) * 1.05 - 0.02, 0, 1)) / 255)
    estimate = estimated(limited, network)
    assert (estimate.verdict, estimate.recognition.kind) == (Verdict.DO_NOT_TRUST, Kind.LIMITED_RANGE)


@pytest.mark.parametrize("kind", ["gray", "color", "blurred"])
@pytest.mark.parametrize("device", [None, Device.CAMERA])
def test_noise_is_not_to_be_trusted_whoever_says_what_took_it(network, kind, device):
    estimate = estimated(noise(kind), network, device=device)
    assert (estimate.verdict, estimate.recognition.kind) == (Verdict.DO_NOT_TRUST, Kind.FLAT)


@pytest.mark.parametrize(
    ("camera", "is_texture", "kind"), [("Canon", True, None), ("Canon", False, Kind.FLAT), ("", True, Kind.FLAT)]
)
def test_only_a_texture_whose_camera_is_named_is_not_noise(network, camera, is_texture, kind):
    """Lawns and gravel have nearly the thumbnails of noise, but neighboring pixels are alike."""
    pixels = quantized(0.5 + 3 * (blurred(noise("gray")) - 0.5)) if is_texture else noise("gray")
    recognition = estimated(pixels, network, metadata=FileMetadata(make=camera)).recognition
    assert (recognition and recognition.kind) is kind


@pytest.mark.parametrize(
    ("options", "is_trusted"),
    [({"metadata": FileMetadata(make="Canon")}, True), ({"device": Device.PHONE}, True), ({}, False)],
)
def test_a_gray_or_toned_picture_is_trusted_only_if_a_camera_is_named(network, plate, options, is_trusted):
    """Of such pictures in plain encodings, from linear light to sRGB, a half looks like photographs."""
    pixels = read_photo(plate).pixels
    toned = quantized(pixels[..., 1:2] * (1, 0.98, 0.9) + np.random.default_rng(0).normal(0, 0.004, pixels.shape))
    toned[:20, :200] = (1, 0, 0)  # a stamp
    for gray in (np.repeat(pixels[..., 1:2], 3, axis=2), toned):
        estimate = estimated(gray, network, **options)
        assert (estimate.verdict is Verdict.USABLE, estimate.recognition) == (is_trusted, None)
    assert estimated(pixels, network).verdict is Verdict.USABLE


@pytest.mark.parametrize("prior", ["camera", "any"])
def test_a_scanner_is_no_camera_and_the_prior_for_scans_is_advised(network, root, prior):
    scan = rendered(root, lambda light: light ** (1 / 2.2))["pixels"]
    photo = Photo(scan, 8, False, Path("a.jpg"), FileMetadata(make="EPSON", model="Perfection V600"))
    estimate = estimate_response(photo, network=network, prior=Prior.load(prior))
    assert ("scan" in [warning.code for warning in estimate.warnings]) is (prior == "camera")
    assert estimate.verdict is Verdict.DO_NOT_TRUST or prior == "any"


@pytest.mark.parametrize(("camera", "verdict"), [({}, "do not trust"), ({"make": "Canon", "model": "EOS R"}, "usable")])
def test_a_mostly_black_picture_is_a_matte_unless_a_camera_is_named(network, plate, camera, verdict):
    pixels = read_photo(plate).pixels.copy()
    pixels[:, : int(0.55 * pixels.shape[1])] = 0
    metadata = FileMetadata(width=pixels.shape[1], height=pixels.shape[0], file_format="PNG", **camera)
    estimate = estimated(pixels, network, metadata=metadata)
    assert (estimate.verdict, bool(estimate.recognition)) == (verdict, not camera)


def test_a_screenshot_is_not_to_be_trusted(network):
    estimate = estimated(screenshot(), network, metadata=FileMetadata(width=960, height=640, file_format="PNG"))
    assert estimate.verdict is Verdict.DO_NOT_TRUST


@pytest.mark.parametrize("power", [1.0, 1.2, 1.8, 2.0, 2.2, 2.4, "sRGB"])
def test_a_plain_render_is_not_to_be_trusted_and_its_error_is_stated(network, root, power):
    encode = srgb_encode if power == "sRGB" else lambda light: light ** (1 / power)
    picture, true = rendered(root, encode), ResponseCurve.from_samples(encode(UNIFORM))
    estimate = estimated(**picture, network=network)
    assert estimate.verdict is Verdict.DO_NOT_TRUST
    assert shape_error(true, estimate.curve) < 2 * estimate.shape_uncertainty
    believed = estimated(**picture, network=network, device=Device.CAMERA)
    assert believed.verdict is Verdict.USABLE
    assert believed.shape_uncertainty < 0.6 * estimate.shape_uncertainty


def test_ordinary_pictures_are_left_alone(network, plate):
    for pixels in (read_photo(plate).pixels, ordinary_picture()):
        estimate = estimated(pixels, network)
        assert estimate.recognition is None
        assert estimate.families[Family.LOG] < 0.5


def test_the_linear_that_programs_write_into_every_dpx_is_not_believed(tmp_path):
    photo = read_photo(write_picture(tmp_path / "a.dpx", ordinary_picture(), dpx__Transfer="Linear"))
    assert photo.metadata.color.transfer == ""
    assert file_origin(photo.metadata).encoding is Encoding.FOOTAGE
