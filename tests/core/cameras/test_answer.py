from dataclasses import replace

import numpy as np
import pytest

from crfnet_core import ResponseCurve, ResponseEstimate, ResponseNetwork, estimate_response, read_photo
from crfnet_core.library import CameraLibrary, camera_estimate, offered_cameras, with_camera
from crfnet_core.library.answer import brightness_per_stop
from crfnet_core.photograph.metadata import FileMetadata, file_origin
from crfnet_core.posterior import Verdict
from tests.helpers.cameras import camera, photograph
from tests.helpers.footage import log_picture, write_picture


@pytest.fixture(scope="module")
def estimate(plate, fixed_model, tmp_path_factory):
    photo = photograph(plate, tmp_path_factory.mktemp("photos") / "a.jpg")
    return estimate_response(read_photo(photo), network=ResponseNetwork.load(fixed_model))


def test_the_errors_of_a_camera_follow_from_its_stops():
    curve, stops = ResponseCurve.gamma(2.0), 0.01
    brighter = curve.forward(np.minimum(curve.irradiance * 2**stops, 1))
    inside = slice(50, 1000)
    moved = (brighter - curve.brightness)[inside]
    assert np.allclose(brightness_per_stop(curve)[inside] * stops, moved, atol=2e-5)
    answer = camera_estimate(camera("a", 2.0, stops=0.2))
    assert answer.uncertainty == pytest.approx(np.hypot(0.05, 0.2) * np.linalg.norm(brightness_per_stop(curve)))
    assert (answer.shape_uncertainty, answer.families) == (0.05, {})
    assert (answer.band[0] <= curve.brightness).all()
    assert (answer.band[1] >= curve.brightness).all()


def test_a_photograph_keeps_its_windows_and_gets_the_camera_s_response(estimate):
    answer = with_camera(estimate, camera("a", make="SONY", model="ILCE-7M3"))
    assert answer.curve == ResponseCurve.gamma(2.2)
    assert (answer.windows, answer.photos, answer.origins) == (estimate.windows, estimate.photos, estimate.origins)
    assert (answer.verdict, answer.warnings, answer.camera.name) == (Verdict.USABLE, (), "a")
    assert ResponseEstimate.from_dict(answer.to_dict()) == answer


def test_photographs_of_another_camera_are_warned_of_once(estimate):
    answer = with_camera(replace(estimate, origins=2 * estimate.origins), camera("a", make="NIKON", model="NIKON D90"))
    (warning,) = answer.warnings
    assert (warning.code, warning.facts["other"]) == ("other_camera", "SONY ILCE-7M3")


def test_footage_stays_untrusted(tmp_path):
    photo = read_photo(write_picture(tmp_path / "log.png", log_picture("Sony S-Log3")))
    alone = estimate_response(photo, network=ResponseNetwork.load())
    answer = with_camera(alone, camera("a"))
    assert (answer.verdict, answer.recognition) == (Verdict.DO_NOT_TRUST, alone.recognition)


def test_cameras_of_the_make_and_model_are_offered(estimate, tmp_path, monkeypatch):
    monkeypatch.setenv("CRFNET_DATA_DIR", str(tmp_path))
    assert offered_cameras(estimate) == ()
    for name, model, stops in (("low", "ILCE-7M3", 0.1), ("high", "ilce-7m3", 0.2), ("other", "ILCE-7M2", 0.1)):
        CameraLibrary.of_user().save(replace(camera(name, make="SONY", model=model), shape_stops=stops))
    assert [offer.name for offer in offered_cameras(estimate)] == ["low", "high"]  # the most exact first
    developed = file_origin(FileMetadata(make="SONY", model="ILCE-7M3", raw_file="1.ARW"))
    for origins in ((), (file_origin(FileMetadata()),), (developed,)):
        assert offered_cameras(replace(estimate, origins=origins)) == ()
