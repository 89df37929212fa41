import re
import shutil

import numpy as np
import pytest

pytest.importorskip("rawpy", reason="raw pairs need the calibrate extra")

from crfnet_core.calibration import calibrate_pairs
from crfnet_core.calibration.raw_pairs.files import find_pairs
from crfnet_core.calibration.raw_pairs.registration import register
from crfnet_core.colorimetry import ADOBE_RGB
from crfnet_core.errors import CalibrationError, PhotoError
from crfnet_core.photograph.camera_raw import read_raw
from crfnet_core.response.metrics import shape_error
from tests.helpers.folders import written
from tests.helpers.images import read_image, write_image
from tests.helpers.linear_pictures import CAMERAS, XYZ, chart, write_dng
from tests.helpers.pairs import PairOptions, make_pair, spoil
from tests.helpers.refusals import refusal_of, refused
from tests.helpers.stacks import light_of

#: Shape errors in stops; the color of the light.
SHAPE, LIGHT = 0.05, (0.7, 1.0, 1.3)

#: Seeds by which `spoil` edits with a program that leaves its name, and with a gradient filter.
SOFTWARE, GRADIENT = 2, 0


@pytest.fixture(scope="session")
def scene(root):
    """The light of a scene with range, in 1024 columns."""
    return light_of(root / "tests" / "data" / "lights" / "interior.exr")


@pytest.fixture
def pair(tmp_path, scene, true_response):
    """Write a pair of the bundled photograph's response: pair(local=0.15) -> its paths."""

    def write(name="shot", shown=scene, **options):
        return make_pair(tmp_path, shown, true_response, PairOptions(**options), name)

    return write


@pytest.fixture(scope="module")
def measured(scene, true_response, tmp_path_factory):
    """A pair with all that a camera does to a picture, and its measurement."""
    options = PairOptions(light=LIGHT, crop=0.02, distortion=0.02, vignetting=0.5)
    tints = np.exp2(np.random.default_rng(0).uniform(-0.7, 0.7, (8, 16, 3))).repeat(64, axis=0).repeat(64, axis=1)
    colored = scene * tints[: scene.shape[0], : scene.shape[1]]
    return calibrate_pairs(make_pair(tmp_path_factory.mktemp("pair"), colored, true_response, options))


def test_one_pair_gives_the_shape_of_the_response(measured, true_response):
    assert shape_error(true_response, measured.curve) < min(SHAPE, 2 * measured.uncertainty.shape_stops)


def test_vignetting_and_the_matrix_are_found_and_no_local_tones(measured):
    """Rows are relative to their sums, because the scale is the exposure's."""
    assert measured.corner == pytest.approx(0.5, abs=0.1)
    assert abs(measured.local) < 0.03
    to_camera = CAMERAS["one"] @ XYZ * LIGHT
    true = np.linalg.inv(to_camera / to_camera.sum(axis=1, keepdims=True))
    np.testing.assert_allclose(measured.matrix / measured.matrix.sum(axis=1, keepdims=True), true, atol=0.2)


def test_several_shots_are_measured_together(pair, true_response):
    found = calibrate_pairs([*pair("first"), *pair("second", light=(1.4, 1, 0.7), brightest=98, seed=1)])
    assert [shot.path.name for shot in found.shots] == ["first.dng", "second.dng"]
    assert found.shots[0].offset == 0
    assert abs(found.shots[1].offset) < 0.1
    assert shape_error(true_response, found.curve) < SHAPE


def test_weak_local_tone_mapping_is_fitted_and_said(pair, true_response):
    """Also in Adobe RGB, which has the same response."""
    found = calibrate_pairs(pair(local=0.06, primaries=ADOBE_RGB))
    assert found.local == pytest.approx(-0.06, abs=0.025)
    assert "local_fitted" in [warning.code for warning in found.warnings]
    assert shape_error(true_response, found.curve) < SHAPE


@pytest.mark.parametrize(
    ("kind", "seed", "code"),
    [
        *((kind, 0, "pair_(differs|cropped)") for kind in ("another scene", "moved", "cropped")),
        ("edited", SOFTWARE, "frame_edited"),
        ("edited", GRADIENT, "pair_tilted"),
    ],
)
def test_what_is_not_the_camera_s_own_jpeg_of_this_shot_is_refused(
    pair, scene, true_response, root, tmp_path, kind, seed, code
):
    other, options = light_of(root / "tests" / "data" / "lights" / "city.exr"), PairOptions(seed=seed)
    paths = pair(seed=seed)
    spoil(kind, tmp_path, paths[1], other, scene, true_response, options)
    assert re.fullmatch(code, refusal_of(CalibrationError, calibrate_pairs, paths).code)
    if code == "frame_edited":
        warnings = calibrate_pairs(paths, accept_edited=True).warnings
        assert "measures_program" in [warning.code for warning in warnings]


def test_a_copy_another_camera_and_the_jpeg_of_another_exposure_are_named(pair, tmp_path):
    first, second = pair("first"), pair("second", seed=1)
    copies = [shutil.copy(path, tmp_path / f"copy{path.suffix}") for path in first]
    assert refusal_of(CalibrationError, calibrate_pairs, [*first, *copies]).code == "frame_twice"
    write_image(second[1], read_image(second[1], kind="uint8"), Make="Canon", ExposureTime=1.1)
    assert refusal_of(CalibrationError, calibrate_pairs, [*first, *second]).code == "frame_camera"
    write_image(second[1], read_image(second[1], kind="uint8"), ExposureTime=2.0)
    assert refusal_of(CalibrationError, calibrate_pairs, second).code == "pair_exposed"


def test_a_shot_without_flat_places_is_named(pair, scene):
    texture = np.exp2(np.random.default_rng(0).uniform(-3, 0, (*scene.shape[:2], 1))).astype(np.float32)
    rough = np.maximum(scene, np.percentile(scene, 80)) * texture
    first, second = pair("first"), pair("second", shown=rough)
    with refused(CalibrationError, "few_cells", path=second[0]):
        calibrate_pairs([*first, *second])


def test_strong_local_tone_mapping_a_dark_picture_and_a_raw_file_alone_are_refused(pair, scene, tmp_path):
    dark = np.append(scene, np.full_like(scene[:9], 60 * scene.max()), axis=0)
    alone = [write_dng(tmp_path / "alone.dng", scene)]
    cases = {"local_tones": pair(local=0.15), "pair_dark": pair("dark", shown=dark), "raw_without_jpeg": alone}
    for code, paths in cases.items():
        assert refusal_of(CalibrationError, calibrate_pairs, paths).code == code


def test_a_raw_file_that_libraw_cannot_read_is_refused_by_its_kind(tmp_path):
    with refused(PhotoError, "raw_not_read", suffix=".gpr"):
        read_raw(written(tmp_path / "broken.gpr", bytes(1000)))


def test_pairs_are_found_by_name(tmp_path):
    names = ["a.NEF", "a.jpg", "b.nef", "B.JPG", "c.nef", "notes.txt", "d.jpg"]
    for name in names:
        (tmp_path / name).touch()
    found = [(raw.name, jpeg and jpeg.name) for raw, jpeg in find_pairs([tmp_path])]
    assert found == [("a.NEF", "a.jpg"), ("b.nef", "B.JPG"), ("c.nef", None)]
    assert find_pairs([tmp_path / "a.NEF"]) == ((tmp_path / "a.NEF", tmp_path / "a.jpg"),)
    assert find_pairs([tmp_path / "a.NEF", tmp_path / "d.jpg"]) == ((tmp_path / "a.NEF", tmp_path / "d.jpg"),)
    for others, code in ((["a.NEF", "b.nef", "d.jpg"], "jpeg_without_raw"), (["d.jpg"], "no_raw_file")):
        assert refusal_of(CalibrationError, find_pairs, [tmp_path / name for name in others]).code == code


@pytest.mark.parametrize(("mirrored", "quarters"), [(False, 0), (False, 1), (True, 0), (True, 3), (False, 2)])
def test_turned_and_mirrored_pictures_are_laid_on_each_other(scene, mirrored, quarters):
    gray = scene.mean(axis=2)[::2, :900:2]
    gray = np.minimum(gray / np.percentile(gray, 98), 1)
    codes = (255 * gray**0.45).astype(np.float32)
    turned = np.rot90(codes[:, ::-1] if mirrored else codes, quarters)
    found = register(gray, np.ascontiguousarray(turned))
    assert (found.mirrored, found.quarters) == (mirrored, quarters)
    assert found.correlation > 0.99
    np.testing.assert_allclose(found.place[:5], 0, atol=2e-3)


def test_raw_light_is_a_part_of_the_sensors_range(tmp_path):
    gray = np.full((80, 3), 0.25)
    gray[40:] = 1.0
    raw = read_raw(write_dng(tmp_path / "chart.dng", chart(gray), light=(0.5, 1, 1)))
    balanced = raw.light * raw.balance
    np.testing.assert_allclose(balanced[8, 8] / balanced[8, 8, 1], 1, atol=1e-3)
    assert raw.light[-8, -8].max() == pytest.approx(1, abs=1e-3)
    assert not raw.is_saturated[8, 8]
    assert raw.is_saturated[-8, -8]
    assert raw.preview == b""


def test_pictures_without_anything_in_common_have_no_correlation(scene):
    gray = scene.mean(axis=2)[::4, ::4].astype(np.float32)
    assert register(gray, np.full((100, 200), 90, np.float32)).correlation == 0
