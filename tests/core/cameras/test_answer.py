"""Photographs accumulate, and a photograph is compared with a camera's response."""

from dataclasses import replace

import numpy as np
import pytest

from crfnet_core import ResponseCurve, ResponseEstimate, ResponseNetwork, estimate_response, read_photo
from crfnet_core.errors import CameraError, CRFNetError, PhotoError
from crfnet_core.files import file_sha256
from crfnet_core.library import (
    Camera,
    CameraLibrary,
    CameraSettings,
    MeasuredResponse,
    add_measured,
    add_photographs,
    camera_estimate,
    compared,
    differences,
    matching_cameras,
    offered_cameras,
    remove_photographs,
    with_camera,
)
from crfnet_core.library.answer import brightness_per_stop
from crfnet_core.library.camera import KEY_LENGTH
from crfnet_core.photograph.metadata import FileMetadata, file_origin
from crfnet_core.posterior import Prior, Verdict
from crfnet_core.response.metrics import estimation_error
from tests.helpers.cameras import photograph
from tests.helpers.footage import log_picture
from tests.helpers.images import write_image


@pytest.fixture(scope="module")
def network():
    return ResponseNetwork.load(threads=1)


@pytest.fixture(scope="module")
def photos(plate, tmp_path_factory):
    folder = tmp_path_factory.mktemp("photos")
    sensitivities = (100, 200, 400)
    return [
        photograph(plate, folder / f"{n}.jpg", seed=n, Exif__PhotographicSensitivity=iso)
        for n, iso in enumerate(sensitivities)
    ]


@pytest.fixture
def library(tmp_path):
    return CameraLibrary(tmp_path / "cameras")


def measured(curve, *, stops=0.05, **settings):
    return MeasuredResponse(curve, 0.05, stops, "6 exposures", CameraSettings(**settings))


def label(network):
    return network.config.label


def test_photographs_added_one_after_the_other_say_what_they_say_together(library, network, photos):
    for photo in photos:
        add_photographs(library, "a", [photo], network=network)
    kept = camera_estimate(library.get("a"), model=label(network))
    together = estimate_response(map(read_photo, photos), network=network)
    assert estimation_error(kept.curve, together.curve) < 1e-9
    assert kept.uncertainty == pytest.approx(together.uncertainty)
    assert (kept.verdict, kept.photos, kept.prior) == (together.verdict, together.photos, together.prior)
    assert kept.origins == together.origins
    assert np.allclose(kept.band, together.band)
    assert kept.camera.basis == "estimated from 3 photographs, ISO 100 to 400"


def test_the_prior_is_chosen_when_a_camera_is_used(library, network, photos):
    camera = add_photographs(library, "a", photos, network=network).camera
    by_prior = [camera_estimate(camera, model=label(network), prior=Prior.load(name)) for name in ("camera", "any")]
    assert [estimate.prior for estimate in by_prior] == ["camera", "any"]
    assert estimation_error(by_prior[0].curve, by_prior[1].curve) > 0.01


def test_a_file_counts_once_whatever_it_is_called(library, network, photos, tmp_path):
    add_photographs(library, "a", photos[:2], network=network)
    copy = tmp_path / "copy.jpg"
    copy.write_bytes(photos[0].read_bytes())
    done = add_photographs(library, "a", [copy, photos[2], photos[2]], network=network)
    assert [one.name for one in done.known] == ["copy.jpg"]
    assert [one.name for one in done.added] == ["2.jpg"]
    assert [one.name for one in done.camera.photographs] == ["0.jpg", "1.jpg", "2.jpg"]


def test_no_pixels_are_kept(library, network, photos):
    add_photographs(library, "a", photos, network=network)
    (path,) = library.folder.glob("*.json")
    assert path.stat().st_size < 12_000 * len(photos)
    assert all(not one.analyzed.photograph.windows for one in library.get("a").photographs)


def test_evidence_of_another_network_does_not_mix(library, network, photos, fixed_model):
    other = ResponseNetwork.load(fixed_model)
    add_photographs(library, "a", photos[:2], network=network)
    camera = add_photographs(library, "a", photos[2:], network=other).camera
    assert camera_estimate(camera, model=label(network)).photos == ("0.jpg", "1.jpg")
    assert camera_estimate(camera, model=label(other)).photos == ("2.jpg",)
    assert {one.name for one in camera.photographs if one.sha256 in differences(camera, model=label(network))} == {
        "0.jpg",
        "1.jpg",
    }
    with pytest.raises(CameraError, match="'a' has no evidence of another network"):
        camera_estimate(camera, model="another network")
    again = add_photographs(library, "a", photos[2:], network=network).camera
    assert len(again.photographs) == 3
    assert camera_estimate(again, model=label(network)).photos == ("0.jpg", "1.jpg", "2.jpg")


def test_one_bad_photograph_adds_none(library, network, photos, tmp_path, plate):
    write_image(tmp_path / "small.png", np.zeros((100, 100, 3), np.uint8))
    other = photograph(plate, tmp_path / "other.jpg", Model="ILCE-7M2")
    for bad in (tmp_path / "none.jpg", tmp_path / "small.png", other):
        with pytest.raises(CRFNetError, match=bad.stem):
            add_photographs(library, "a", [photos[0], bad], network=network)
    assert library.cameras() == []


def test_log_footage_is_not_kept(library, network, tmp_path):
    footage = np.rint(log_picture("Sony S-Log3") * 255).astype(np.uint8)
    path = write_image(tmp_path / "log.png", footage)
    assert estimate_response(read_photo(path), network=network).recognition is not None
    with pytest.raises(PhotoError, match="a camera is known by photographs as it wrote them"):
        add_photographs(library, "a", [path], network=network)


def test_photographs_are_taken_out_but_never_all(library, network, photos):
    add_photographs(library, "a", photos, network=network)
    assert len(remove_photographs(library, "a", ["0.jpg", "1.jpg"]).photographs) == 1
    with pytest.raises(CameraError, match=r"has no photograph 0\.jpg"):
        remove_photographs(library, "a", ["0.jpg"])
    with pytest.raises(CameraError, match="nothing would be left"):
        remove_photographs(library, "a", ["2.jpg"])
    assert len(library.get("a").photographs) == 1


def test_photographs_of_one_file_name_are_taken_out_one_by_one(library, network, photos, tmp_path):
    (tmp_path / "day 2").mkdir()
    namesake = tmp_path / "day 2" / "0.jpg"
    namesake.write_bytes(photos[1].read_bytes())
    camera = add_photographs(library, "a", [photos[0], namesake, photos[2]], network=network).camera
    keys = [file_sha256(photos[0])[:KEY_LENGTH], file_sha256(namesake)[:KEY_LENGTH], "2.jpg"]
    assert [camera.key_of(one) for one in camera.photographs] == keys
    with pytest.raises(CameraError, match=f"has 2 photographs 0.jpg; name one by its SHA-256: {keys[0]}, {keys[1]}"):
        remove_photographs(library, "a", ["0.jpg"])
    assert len(library.get("a").photographs) == 3
    with pytest.raises(CameraError, match="has no photograph"):
        remove_photographs(library, "a", [keys[1][:-1]])
    left = remove_photographs(library, "a", [keys[1].upper()])
    assert [one.sha256 for one in left.photographs] == [camera.photographs[n].sha256 for n in (0, 2)]
    assert [one.name for one in remove_photographs(library, "a", ["0.jpg"]).photographs] == ["2.jpg"]


def test_a_measured_response_is_the_answer_and_photographs_are_compared_with_it(library, network, photos):
    curve = ResponseCurve.gamma(1.8)
    add_photographs(library, "a", photos, network=network)
    camera = add_measured(library, "a", measured(curve, make="SONY", model="ILCE-7M3"))
    answer = camera_estimate(camera, model="any network")
    assert answer.curve == curve
    assert (answer.verdict, answer.shape_uncertainty, answer.families) == (Verdict.GOOD, 0.05, {})
    assert len(differences(camera, model=label(network))) == 3


def test_the_errors_of_a_measured_response_follow_from_its_stops():
    """A little more light, by a known number of stops, moves brightness by what `brightness_per_stop` says."""
    curve, stops = ResponseCurve.gamma(2.0), 0.01
    brighter = curve.forward(np.minimum(curve.irradiance * 2**stops, 1))
    inside = slice(50, 1000)
    moved = (brighter - curve.brightness)[inside]
    assert np.allclose(brightness_per_stop(curve)[inside] * stops, moved, atol=2e-5)
    answer = camera_estimate(Camera("a", measured(curve, stops=0.2)), model="")
    assert answer.uncertainty == pytest.approx(np.hypot(0.05, 0.2) * np.linalg.norm(brightness_per_stop(curve)))
    assert (answer.band[0] <= curve.brightness).all()
    assert (answer.band[1] >= curve.brightness).all()


def test_a_photograph_keeps_its_windows_and_gets_the_camera_s_response(network, photos, true_response):
    own = estimate_response(read_photo(photos[0]), network=network)
    camera = Camera("a", measured(true_response, make="SONY", model="ILCE-7M3"))
    answer = with_camera(own, camera)
    assert answer.curve == true_response
    assert (answer.windows, answer.photos, answer.origins, answer.model) == (
        own.windows,
        own.photos,
        own.origins,
        own.model,
    )
    assert answer.camera.agrees
    assert (answer.verdict, answer.warnings) == (Verdict.GOOD, ())
    assert ResponseEstimate.from_dict(answer.to_dict()) == answer


def test_a_photograph_that_disagrees_is_warned_of(network, photos):
    own = estimate_response(read_photo(photos[0]), network=network)
    answer = with_camera(own, Camera("a", measured(ResponseCurve.gamma(4))))
    assert not answer.camera.agrees
    assert answer.verdict is Verdict.USABLE
    assert answer.warnings[0].code == "camera_disagrees"


def test_a_photograph_of_another_camera_is_warned_of(network, photos, true_response):
    own = estimate_response(read_photo(photos[0]), network=network)
    answer = with_camera(own, Camera("a", measured(true_response, make="NIKON", model="NIKON D90")))
    assert "the photograph is of SONY ILCE-7M3, but 'a' is NIKON D90" in map(str, answer.warnings)


def test_what_is_no_photograph_of_a_camera_stays_untrusted(network, true_response, tmp_path):
    footage = np.rint(log_picture("Sony S-Log3") * 255).astype(np.uint8)
    own = estimate_response(read_photo(write_image(tmp_path / "log.png", footage)), network=network)
    answer = with_camera(own, Camera("a", measured(true_response)))
    assert answer.verdict is Verdict.DO_NOT_TRUST
    assert answer.recognition == own.recognition


def test_cameras_of_the_make_and_model_fit_the_nearest_sensitivity_first(
    tmp_path, monkeypatch, network, photos, fixed_model
):
    monkeypatch.setenv("CRFNET_DATA_DIR", str(tmp_path))
    library = CameraLibrary.of_user()
    settings = CameraSettings("SONY", "ILCE-7M3", iso=(1600,))
    assert matching_cameras(settings) == []
    for name, iso in (("low", 100), ("high", 3200)):
        add_measured(library, name, measured(ResponseCurve.gamma(), make="SONY", model="ILCE-7M3", iso=(iso,)))
    add_measured(library, "other", measured(ResponseCurve.gamma(), make="SONY", model="ILCE-7M2"))
    add_photographs(library, "old", photos[:1], network=ResponseNetwork.load(fixed_model))
    assert [camera.name for camera in matching_cameras(settings)] == ["high", "low", "old"]
    assert matching_cameras(CameraSettings()) == []
    own = estimate_response(read_photo(photos[0]), network=network)
    offers = offered_cameras(own, settings)
    assert [offer.name for offer in offers] == ["high", "low"]
    assert offers[0] == compared(own, library.get("high"))
    developed = file_origin(FileMetadata(raw_file="1.ARW"))
    assert offered_cameras(replace(own, origins=(developed,)), settings) == []
