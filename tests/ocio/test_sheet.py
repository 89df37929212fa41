import dataclasses

import numpy as np
import pytest

from crfnet_core import ResponseNetwork, estimate_response, read_photo
from crfnet_core.estimate.result import CameraAnswer
from crfnet_core.posterior import Family, Verdict
from tests.helpers.images import read_image

sheet = pytest.importorskip("crfnet.report.sheet", reason="needs matplotlib, of the plot extra")


@pytest.fixture(scope="module")
def photo(plate):
    return read_photo(plate)


@pytest.fixture(scope="module")
def estimate(photo, fixed_model):
    return estimate_response(photo, network=ResponseNetwork.load(fixed_model))


def read_codes(path):
    return read_image(path, kind="uint8").astype(int)


def test_the_same_estimate_gives_the_same_bytes(photo, estimate, tmp_path):
    for name in ("a.png", "b.png"):
        sheet.draw_sheet(tmp_path / name, photo.pixels, estimate)
    content = (tmp_path / "a.png").read_bytes()
    assert content == (tmp_path / "b.png").read_bytes()
    assert b"Software" not in content
    assert b"tIME" not in content


def test_has_the_stated_size_and_shows_the_curve_in_its_color(photo, estimate, tmp_path):
    sheet.draw_sheet(tmp_path / "a.png", photo.pixels, estimate)
    codes = read_codes(tmp_path / "a.png")
    assert codes.shape[1::-1] == tuple(round(side * sheet.DPI) for side in sheet.SIZE)
    curve = np.array([0x0B, 0x66, 0xC3])
    assert (np.abs(codes[:, :900, :3] - curve).max(axis=2) < 3).sum() > 2000


def test_the_windows_lie_where_they_were_whatever_the_preview(photo, estimate, tmp_path):
    """A preview of every second pixel moves no window: the two pictures differ in sharpness only."""
    sheet.draw_sheet(tmp_path / "all.png", photo.pixels, estimate)
    sheet.draw_sheet(tmp_path / "half.png", photo.pixels[::2, ::2], estimate, stride=2)
    assert np.abs(read_codes(tmp_path / "all.png") - read_codes(tmp_path / "half.png")).mean() < 3


def test_a_stored_camera_s_response_shows_neither_model_nor_windows(photo, estimate, tmp_path):
    stored = dataclasses.replace(estimate, camera=CameraAnswer("A7", "20 exposures"))
    for name, each in {"a.png": stored, "b.png": dataclasses.replace(stored, windows=(), model="")}.items():
        sheet.draw_sheet(tmp_path / name, photo.pixels, each)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


@pytest.mark.parametrize(
    ("shape", "is_beside"),
    [((1, 1), True), ((300, 300), True), ((300, 200), True), ((900, 300), True), ((200, 300), False)],
)
def test_square_photographs_and_portraits_lie_beside_their_linear_plate(estimate, tmp_path, shape, is_beside):
    """Whichever shows them larger: the upper half of the sheet then has a picture next to the curve."""
    sheet.draw_sheet(tmp_path / "a.png", np.full((*shape, 3), 0.5, np.float32), estimate)
    next_to_the_curve = read_codes(tmp_path / "a.png")[300:500, 970:1100, :3]
    assert (next_to_the_curve.min() < 255) == is_beside


@pytest.mark.parametrize("verdict", Verdict)
@pytest.mark.parametrize("name", ["plain.jpg", "long name " * 20 + ".jpg", "写真 $x_1$ \\frac 🎬.jpg"])
def test_any_estimate_can_be_drawn(photo, estimate, tmp_path, recwarn, verdict, name):
    warnings = () if verdict is Verdict.USABLE else ("a warning that is long enough to go on and on " * 6,)
    origin = dataclasses.replace(estimate.origins[0], words=(f"taken by {name}", f"saved by {name}"))
    origins = (origin, estimate.origins[0])
    other = dataclasses.replace(estimate, verdict=verdict, photos=(name, "b.jpg"), warnings=warnings, origins=origins)
    sheet.draw_sheet(tmp_path / "a.png", photo.pixels, other)
    assert not recwarn.list


def test_no_line_leaves_the_sheet(photo, estimate, tmp_path):
    """The widest that is usual: the right margin stays white."""
    families = dict.fromkeys(Family, 0.0) | {Family.UNEXPLAINED: 0.62, Family.CAMERA: 0.38}
    origin = dataclasses.replace(estimate.origins[0], words=("taken by a camera with a long name",) * 9)
    wide = dataclasses.replace(
        estimate,
        verdict=Verdict.DO_NOT_TRUST,
        uncertainty=4.32,
        families=families,
        origins=(origin,),
        photos=("a long name of a photograph " * 3,) * 12,
        warnings=("a warning",) * 30,
    )
    sheet.draw_sheet(tmp_path / "a.png", photo.pixels, wide)
    assert (read_codes(tmp_path / "a.png")[:, -20:] == 255).all()


def test_matplotlibs_settings_are_left_alone(photo, estimate, tmp_path):
    import matplotlib as mpl

    before = dict(mpl.rcParams)
    sheet.draw_sheet(tmp_path / "a.png", photo.pixels, estimate)
    assert dict(mpl.rcParams) == before
