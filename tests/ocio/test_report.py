"""What is said of an estimate: stops first, the kind of response, what it rests on; figures made by hand."""

import dataclasses
import math

import pytest

from crfnet.report import facts, words
from crfnet_core import AnalysisOptions, ResponseNetwork, estimate_response, read_photo
from crfnet_core.photograph.metadata import Device, FileMetadata, file_origin, with_stated_device
from crfnet_core.posterior import Family, Verdict

CANON = FileMetadata(width=3504, height=2336, make="Canon", model="Canon EOS 20D", file_format="TIFF")


@pytest.fixture(scope="module")
def found(plate, fixed_model):
    network, options = ResponseNetwork.load(fixed_model), AnalysisOptions(windows=2)
    return estimate_response(read_photo(plate), network=network, options=options)


@pytest.fixture
def estimate(found):
    """An estimate with given fields: by default a usable one of a camera's photograph."""

    def make(*, families=None, **fields):
        shares = dict.fromkeys(Family, 0.0) | (families or {Family.PHONE: 0.03, Family.CAMERA: 0.9, Family.FILM: 0.07})
        usual = {"verdict": Verdict.USABLE, "uncertainty": 1.25, "shape_uncertainty": 0.1, "families": shares}
        usual |= {"prior": "camera", "origins": (file_origin(CANON),), "warnings": ()}
        return dataclasses.replace(found, **(usual | fields))

    return make


def test_the_lines_of_an_estimate(estimate):
    *lines, windows = words.verdict_lines(estimate())
    assert lines == [
        "The estimate is usable: look at the linear plate before you rely on it.",
        "Expected error: 0.10 stop in the linear light once the exposure is matched (RMS, codes 16 to 240), 3.9 % of"
        " the brightness range (E_est 1.25) in the curve; gamma 2.2 usually has 0.7 stop and 12 %.",
        words.RANK,
        "Most likely a camera's own rendering, 93 %.",
        "Prior: camera; metadata: taken by Canon EOS 20D, a camera with interchangeable lenses.",
    ]
    assert windows.endswith(" of 2 analyzed windows agree.")


@pytest.mark.parametrize(
    ("fields", "text"),
    [
        *(({"shape_uncertainty": float(text)}, f"{text} stop") for text in ("0.3002", "0.2998", "0.30", "0.11")),
        ({"shape_uncertainty": 0.3 + 1e-9}, "0.300000 stop"),
        ({"uncertainty": 2.504}, "(E_est 2.50)"),
    ],
)
def test_a_number_lies_on_the_side_of_a_limit_that_the_verdict_says(estimate, fields, text):
    assert text in words.verdict_lines(estimate(**fields))[1]


def test_warnings_come_last_also_in_the_line_for_lists(estimate):
    assert words.verdict_lines(estimate(warnings=("dark", "gray")))[-2:] == ["Warning: dark.", "Warning: gray."]
    line = words.result_line(estimate(warnings=("dark",)), name="plate.jpg")
    assert line == (
        "plate.jpg: usable, expected error 0.10 stop, 3.9 % of the brightness range (E_est 1.25);"
        " a camera's own rendering, 93 %; dark"
    )


def test_luts_say_how_far_to_trust_them(estimate):
    assert facts.provenance(estimate())[-2:] == (
        "Verdict: usable, expected error 0.10 stop, 3.9 % of the brightness range (E_est 1.25)",
        "Most likely a camera's own rendering, 93 %. Prior: camera; metadata: taken by Canon EOS 20D, a camera with"
        " interchangeable lenses",
    )


@pytest.mark.parametrize(
    ("families", "words"),
    [
        ({Family.PHONE: 0.5, Family.CAMERA: 0.1, Family.FILM: 0.4}, "a camera's own rendering, 60 %"),
        ({Family.EDITED: 0.35, Family.FILM: 0.2, Family.CAMERA: 0.45}, "edited or unusual, 55 %"),
        ({Family.LINEAR: 0.8, Family.CAMERA: 0.2}, "nearly linear: do not trust, 80 %"),
        ({Family.LOG: 1.0}, "log-like: do not trust, over 99 %"),
        ({Family.CAMERA: 0.5, Family.LOG: 0.5}, "a camera's own rendering, 50 %"),
        ({Family.UNEXPLAINED: 0.48, Family.CAMERA: 0.3, Family.FILM: 0.22}, "a camera's own rendering, 30 %"),
        ({Family.CAMERA: 0.45, Family.LOG: 0.3, Family.LINEAR: 0.25}, "log-like: do not trust, 30 %"),
    ],
)
def test_the_likely_kind_is_of_the_side_that_the_verdict_takes(estimate, families, words):
    assert str(estimate(families=families).likely_kind) == words


@pytest.mark.parametrize("family", words.REMEDIES)
def test_the_remedy_follows_the_kind(estimate, family):
    first = words.verdict_lines(estimate(families={family: 1.0}, verdict=Verdict.DO_NOT_TRUST))[0]
    assert first == f"The estimate is not to be trusted: {words.REMEDIES[family]}."


def test_of_a_cameras_photograph_its_own_file_or_a_measurement_helps(estimate):
    first = words.verdict_lines(estimate(verdict=Verdict.DO_NOT_TRUST))[0]
    assert first == "The estimate is not to be trusted: give the file that the camera wrote, or run crfnet calibrate."


def test_who_says_what_took_the_photograph(estimate):
    unnamed = file_origin(dataclasses.replace(CANON, make="", model="", width=600, height=400))
    told = with_stated_device(unnamed, Device.PHONE)
    assert facts.basis(estimate(origins=(told,))) == (
        "Prior: camera; you and the file say: taken with a phone, probably scaled after the camera wrote it (600 x 400"
        " pixels)"
    )
    bare = with_stated_device(file_origin(FileMetadata()), Device.COMPACT)
    assert facts.basis(estimate(origins=(bare,))) == "Prior: camera; you say: taken with a compact camera"
    assert facts.basis(estimate(origins=())) == "Prior: camera; no metadata used"


def test_an_unexplained_picture_of_no_known_device_asks_for_it(estimate):
    fields = {"verdict": Verdict.DO_NOT_TRUST, "families": {Family.UNEXPLAINED: 1.0}}
    asked = "with --taken-with which kind of camera took it, if it is a photograph."
    assert words.verdict_lines(estimate(**fields, origins=()))[0].endswith(asked)
    assert words.verdict_lines(estimate(**fields, origins=(file_origin(FileMetadata()),)))[0].endswith(asked)
    assert not words.verdict_lines(estimate(**fields))[0].endswith(asked)
    drone = file_origin(dataclasses.replace(CANON, make="DJI", model="FC3170"))
    assert not words.verdict_lines(estimate(**fields, origins=(drone,)))[0].endswith(asked)
    assert not words.verdict_lines(estimate(**fields, origins=(), windows=()))[0].endswith(asked)


def test_what_an_earlier_version_did_not_store_is_left_out(estimate):
    stored = dataclasses.replace(estimate(), shape_uncertainty=math.nan, families={}, prior="", origins=())
    *lines, _ = words.verdict_lines(stored)
    assert lines == [
        "The estimate is usable: look at the linear plate before you rely on it.",
        "Expected error: 3.9 % of the brightness range (E_est 1.25) in the curve; gamma 2.2 usually has 12 %.",
    ]
    assert facts.provenance(stored)[-1] == "Verdict: usable, expected error 3.9 % of the brightness range (E_est 1.25)"
    assert words.result_line(stored, name="plate.jpg").endswith("(E_est 1.25)")
