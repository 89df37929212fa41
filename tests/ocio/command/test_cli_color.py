"""Primaries, spaces and exposures through the whole command, judged by colour-science and OpenColorIO."""

import json

import numpy as np
import pytest

from crfnet.luts.files import WRITERS, read_lut, write_lut
from crfnet.luts.lut1d import inverse_response_lut
from crfnet_core import ResponseCurve, read_photo
from crfnet_core.colorimetry import ADOBE_RGB, DISPLAY_P3, PROPHOTO, REC709
from tests.helpers.color_profiles import matrix_profile, profile, write_tagged
from tests.helpers.configs import converted, loaded
from tests.helpers.folders import listed
from tests.helpers.images import read_image
from tests.helpers.plates import attributes, read_exr

colour = pytest.importorskip("colour")

#: A response that is not a standard one, and light of all colours in it.
CURVE = ResponseCurve.from_samples(1 - (1 - np.linspace(0, 1, 4096)) ** 2)
LIGHT = np.random.default_rng(0).uniform(0.02, 0.95, (24, 32, 3))

#: Our primaries, and colour-science's names of them.
SPACES = {"p3": (DISPLAY_P3, "Display P3"), "adobe": (ADOBE_RGB, "Adobe RGB (1998)"), "rec709": (REC709, "sRGB")}

TABLES = profile({"A2B0": b"mft2".ljust(52, b"\0")})


def to_space(light, source, target):
    """Return linear light in another space of colour-science, adapted by Bradford."""
    spaces = [colour.RGB_COLOURSPACES[name].copy() for name in (source, target)]
    for space in spaces:
        space.use_derived_transformation_matrices(True)
    return light @ colour.matrix_RGB_to_RGB(*spaces, chromatic_adaptation_transform="Bradford").T


@pytest.fixture(scope="module")
def lut_file(tmp_path_factory):
    """The inverse of the response, with an entry for every code of 16 bits."""
    path = tmp_path_factory.mktemp("lut") / "known.spi1d"
    write_lut(path, inverse_response_lut(CURVE, length=65536))
    return path


@pytest.fixture
def tagged(tmp_path):
    """Write the light as a camera would encode it in these primaries: tagged(name, icc) -> path."""

    def write(name, icc):
        largest = 255 if name.endswith(".jpg") else 65535
        codes = np.rint(CURVE.forward(LIGHT) * largest).astype(np.uint8 if largest == 255 else np.uint16)
        return write_tagged(tmp_path / name, codes, icc)

    return write


@pytest.fixture
def linearized(crfnet, lut_file, tmp_path):
    """Run `crfnet linearize` to float: linearized(plate, ...) -> pixels and attributes."""

    def run(plate, *arguments):
        out = tmp_path / "linear.exr"
        options = ("--lut", lut_file, "--out", out, "--depth", "float", "--overwrite")
        assert crfnet("linearize", plate, *options, *arguments).printed
        pixels, spec = read_exr(out)
        return pixels, attributes(spec)

    return run


class TestPrimaries:
    @pytest.mark.parametrize("output", ["ACES2065-1", "ACEScg", "scene_linear"])
    @pytest.mark.parametrize("name", SPACES)
    def test_the_colors_are_the_true_ones(self, tagged, linearized, name, output):
        primaries, source = SPACES[name]
        target = "sRGB" if output == "scene_linear" else output
        pixels, found = linearized(tagged("a.tif", matrix_profile(primaries)), "--output-space", output)
        expected = to_space(LIGHT, source, target)
        if target == "ACES2065-1":
            assert np.abs(pixels / expected - 1).max() < 1e-3
        np.testing.assert_allclose(pixels, expected, atol=5e-4)
        assert (found["crfnet:primaries"], found["crfnet:primariesSource"]) == (primaries.name, "ICC profile")
        ids = {"ACES2065-1": "lin_ap0_scene", "ACEScg": "lin_ap1_scene", "scene_linear": "lin_rec709_scene"}
        assert found["colorInteropID"] == ids[output]
        assert "chromaticities" not in found

    @pytest.mark.parametrize(
        ("primaries", "interop_id"),
        [(DISPLAY_P3, "lin_p3d65_scene"), (ADOBE_RGB, "lin_adobergb_scene"), (PROPHOTO, "unknown")],
    )
    def test_the_plates_own_space_is_named_or_described(self, tagged, linearized, primaries, interop_id):
        pixels, found = linearized(tagged("a.tif", matrix_profile(primaries)), "--output-space", "plate")
        np.testing.assert_allclose(pixels, LIGHT, atol=5e-4)
        assert found["colorInteropID"] == interop_id
        if primaries is PROPHOTO:
            expected = [*PROPHOTO.red, *PROPHOTO.green, *PROPHOTO.blue, *PROPHOTO.white]
            np.testing.assert_allclose(found["chromaticities"], expected, atol=1e-6)
        else:
            assert "chromaticities" not in found

    def test_what_is_given_outweighs_the_tag(self, tagged, linearized):
        pixels, found = linearized(tagged("a.tif", matrix_profile(ADOBE_RGB)), "--primaries", "p3")
        np.testing.assert_allclose(pixels, to_space(LIGHT, "Display P3", "sRGB"), atol=5e-4)
        assert (found["crfnet:primaries"], found["crfnet:primariesSource"]) == ("Display P3", "as given")

    def test_unknown_primaries_are_left_and_called_unknown(self, tagged, linearized):
        pixels, found = linearized(tagged("a.tif", TABLES))
        np.testing.assert_allclose(pixels, LIGHT, atol=5e-4)
        assert (found["colorInteropID"], found["crfnet:primaries"]) == ("unknown", "unknown")
        assert "chromaticities" not in found

    def test_a_published_encoding_is_named_apart_from_the_primaries(self, crfnet, tagged, lut_file, tmp_path):
        icc = matrix_profile(DISPLAY_P3, cicp=b"cicp" + bytes(4) + bytes([12, 16, 0, 1]))
        done = crfnet("linearize", tagged("a.tif", icc), "--lut", lut_file, "--out", tmp_path / "a.exr", "--json")
        found = json.loads(done.out)
        assert (found["primaries"]["source"], found["tagged"]) == ("ICC profile", "PQ (ICC profile)")

    def test_unknown_primaries_are_not_converted_to_aces(self, crfnet, tagged, lut_file, tmp_path):
        arguments = ("linearize", tagged("a.tif", TABLES), "--lut", lut_file, "--out", tmp_path / "a.exr")
        assert crfnet(*arguments, "--output-space", "ACEScg").refusal == "primaries_unknown"
        assert not (tmp_path / "a.exr").exists()
        assert crfnet(*arguments, "--output-space", "ACEScg", "--primaries", "rec2020").code == 0

    def test_photographs_of_one_response_have_primaries_in_common(self, estimate, plate, tmp_path):
        other = write_tagged(tmp_path / "p3.jpg", read_image(plate, kind="uint8"), matrix_profile(DISPLAY_P3))
        assert estimate(plate, other).refusal == "primaries_differ"
        assert not (tmp_path / "out").exists()
        assert estimate(plate, other, "--primaries", "p3", "--no-linear").code == 0
        each = ("--each", "--overwrite", "--no-linear", "--workers", "1")
        assert estimate(plate, other, *each).code == 0

    @pytest.mark.parametrize("words", ["its primaries are Rec.709", "its transfer function is PQ"])
    def test_a_frame_of_other_primaries_or_another_encoding_fails(self, crfnet, tagged, lut_file, tmp_path, words):
        pq = matrix_profile(DISPLAY_P3, cicp=b"cicp" + bytes(4) + bytes([12, 16, 0, 1]))
        other = matrix_profile(REC709) if "Rec.709" in words else pq
        for number, icc in enumerate((matrix_profile(DISPLAY_P3), matrix_profile(DISPLAY_P3), other), 1):
            tagged(f"shot.{number}.tif", icc)
        done = crfnet("linearize", tmp_path / "shot.%d.tif", "--lut", lut_file, "--out", tmp_path / "l.%d.exr")
        assert (done.refusal, f"shot.3.tif: {words}" in done.err) == ("frames_failed", True)
        assert [name for name in listed(tmp_path) if name.endswith(".exr")] == ["l.1.exr", "l.2.exr"]


class TestConfig:
    @pytest.fixture
    def folder(self, crfnet, plate, fixed_model, tmp_path):
        """What `crfnet estimate` writes for the bundled photograph, tagged as Display P3: folder(...) -> the folder."""

        def run(*arguments):
            pixels = read_image(plate, kind="uint8")
            photo = write_tagged(tmp_path / "shot.png", pixels, matrix_profile(DISPLAY_P3))
            out = ("--out", tmp_path / "look", "--no-sheet", "--overwrite", "--depth", "float")
            assert crfnet("estimate", photo, *out, "--model", fixed_model, *arguments).printed
            return tmp_path / "look"

        return run

    @pytest.mark.parametrize("output", ["scene_linear", "ACES2065-1", "ACEScg", "plate"])
    @pytest.mark.parametrize("exposure", ["white", "gray"])
    def test_its_processor_equals_the_exr(self, folder, plate, tolerance, output, exposure):
        look = folder("--output-space", output, "--exposure", exposure)
        space = "lin_p3d65_scene" if output == "plate" else output
        codes = read_photo(plate).pixels[::8, ::8].reshape(-1, 3)
        found = converted(loaded(look / "config.ocio"), "CRF shot", space, codes)
        expected = read_image(look / "shot_linear.exr")[::8, ::8].reshape(-1, 3)
        np.testing.assert_allclose(found, expected, atol=2 * tolerance.plate)

    def test_the_exposure_can_be_edited_after_the_lut(self, folder):
        path = folder("--exposure", "0.5") / "config.ocio"
        text = path.read_text(encoding="utf-8")
        steps = text[text.index("name: CRF shot\n") :]
        assert steps.index("FileTransform") < steps.index("ExposureContrastTransform") < steps.index("MatrixTransform")
        before = converted(loaded(path), "CRF shot", "scene_linear", [[0.5, 0.5, 0.5]])
        assert text.count("exposure: 0.5,") == 3  # the colour space, and its two views
        path.write_text(text.replace("exposure: 0.5,", "exposure: 1.5,"), encoding="utf-8")
        after = converted(loaded(path), "CRF shot", "scene_linear", [[0.5, 0.5, 0.5]])
        np.testing.assert_allclose(after, 2 * before, rtol=1e-5)

    def test_everything_names_the_primaries(self, folder):
        look = folder()
        found = json.loads((look / "shot.json").read_text(encoding="utf-8"))
        assert (found["primaries"]["name"], found["primaries"]["source"]) == ("Display P3", "ICC profile")
        assert found["primaries"]["green"] == [0.265, 0.69]
        assert found["output_space"] == {"name": "linear Rec.709", "interop_id": "lin_rec709_scene"}
        assert "primaries Display P3 (ICC profile)" in (look / "config.ocio").read_text(encoding="utf-8")
        for suffix in WRITERS:
            comments = read_lut(look / f"shot{suffix}").comments
            assert comments[-1] == "Primaries: Display P3 (ICC profile); the LUT leaves them as they are"


@pytest.mark.parametrize(
    ("output", "space", "to_aces"),
    [
        ("ACEScg", "ACEScg", "ACEScg"),
        ("ACES2065-1", "ACES2065-1", "ACES2065-1"),
        ("plate", "Linear DCI-P3 D65", "Display P3"),
        ("scene_linear", "Linear Rec.709", "sRGB"),
    ],
)
def test_the_config_finds_the_linear_plate_in_its_space(crfnet, fixed_model, plate, tmp_path, output, space, to_aces):
    photo = write_tagged(tmp_path / "shot.0001.png", read_image(plate, kind="uint8"), matrix_profile(DISPLAY_P3))
    look = tmp_path / "look"
    arguments = ("--no-sheet", "--depth", "float", "--output-space", output, "--model", fixed_model)
    assert crfnet("estimate", photo, "--out", look, *arguments).code == 0
    config = loaded(look / "config.ocio")
    for name in ("shot.0001_linear.exr", "shot.0002_linear.EXR", "linear/shot.0001.exr"):
        assert config.getColorSpaceFromFilepath(str(look / name))[0] == space
    assert config.getColorSpaceFromFilepath("beauty.0001.exr")[0] == "scene_linear"
    encoded, _ = config.getColorSpaceFromFilepath(str(photo))
    linear = read_exr(look / "shot.0001_linear.exr")[0][::40, ::40].reshape(-1, 3)
    codes = read_photo(photo).pixels[::40, ::40].reshape(-1, 3)
    expected = converted(config, encoded, "ACES2065-1", codes)
    np.testing.assert_allclose(converted(config, space, "ACES2065-1", linear), expected, atol=1e-5)
    np.testing.assert_allclose(to_space(linear, to_aces, "ACES2065-1"), expected, atol=1e-4)


def test_the_config_of_many_finds_each_linear_plate(crfnet, fixed_model, plate, tmp_path):
    for name, primaries in (("a.png", DISPLAY_P3), ("b.png", ADOBE_RGB), ("c.png", REC709)):
        write_tagged(tmp_path / name, read_image(plate, kind="uint8"), matrix_profile(primaries))
    arguments = ("--each", "--workers", 1, "--no-sheet", "--output-space", "plate", "--model", fixed_model)
    assert crfnet("estimate", tmp_path, "--out", tmp_path / "look", *arguments).code == 0
    config = loaded(tmp_path / "look" / "config.ocio")
    found = [config.getColorSpaceFromFilepath(f"/x/{name}_linear.exr")[0] for name in "abc"]
    assert found == ["Linear DCI-P3 D65", "Linear AdobeRGB", "Linear Rec.709"]
