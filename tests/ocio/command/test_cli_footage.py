"""`crfnet` on inputs that are not camera photographs, and on HEIC: what it says, writes and returns."""

import json
import shutil

import OpenImageIO as oiio
import pytest

from tests.helpers.footage import log_picture, ordinary_picture, write_picture
from tests.helpers.images import read_image


@pytest.mark.parametrize(
    ("pixels", "kind", "words", "curves"),
    [
        (log_picture("Panasonic V-Log"), "log footage", 'in ACES configs "V-Log V-Gamut"', ["Panasonic V-Log"]),
        ((16 + 219 * ordinary_picture().astype(float)) / 255, "limited range", "in_range=limited:out_range=full", []),
    ],
    ids=["log", "limited"],
)
def test_other_pictures_are_answered_with_what_helps(crfnet, tmp_path, pixels, kind, words, curves):
    path = write_picture(tmp_path / "a.png", pixels, Make="Panasonic", Model="DC-S5")
    done = crfnet("estimate", path, "--out", tmp_path / "look", "--no-sheet")
    assert (done.code, words in done.out) == (0, True)
    found = json.loads((tmp_path / "look" / "a.json").read_text(encoding="utf-8"))
    assert (found["verdict"], found["recognition"]["kind"]) == ("do not trust", kind)
    assert found["recognition"]["curves"] == curves


@pytest.mark.parametrize("command", ["estimate", "linearize"])
@pytest.mark.parametrize(
    ("name", "tag", "code"),
    [
        *(("scan.dpx", {"dpx__Transfer": kind}, "tagged_encoding") for kind in ("Printing density", "Logarithmic")),
        ("pq.png", {"CICP": (oiio.TypeDesc("int[4]"), (9, 16, 0, 1))}, "tagged_color_space"),
        ("hlg.png", {"CICP": (oiio.TypeDesc("int[4]"), (9, 18, 0, 1))}, "tagged_color_space"),
        ("linear.png", {"CICP": (oiio.TypeDesc("int[4]"), (1, 8, 0, 1))}, "tagged_linear"),
    ],
)
def test_a_frame_that_calls_itself_log_or_linear_is_refused_and_nothing_is_written(
    crfnet, fixed_model, tmp_path, command, name, tag, code
):
    path = write_picture(tmp_path / name, ordinary_picture(), **tag)
    out = tmp_path / ("look" if command == "estimate" else "linear.exr")
    arguments = (command, path, "--out", out, "--model", fixed_model)
    assert crfnet(*arguments).refusal == code
    assert not out.exists()
    assert crfnet(*arguments, "--ignore-metadata").code == 0


def test_a_phones_heic_gives_a_linear_plate(crfnet, look, root, tmp_path):
    """The test files are smaller than a window, so the plate is made with a LUT."""
    plate = shutil.copy(root / "tests/data/heif/phone.heic", tmp_path / "IMG_0001.HEIC")
    assert crfnet("linearize", plate, "--lut", look / "plate.spi1d", "--out", tmp_path / "linear.exr").code == 0
    assert read_image(tmp_path / "linear.exr").shape == (64, 48, 3)
