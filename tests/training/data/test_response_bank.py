import numpy as np
import pytest
import scipy.io

from crfnet_core.posterior import Family, ResponseBank
from crfnet_core.response.curve import UNIFORM, ResponseCurve
from training.data import response_bank
from training.data.real_photographs import Body
from training.data.response_bank import COUNTS, make_bank, write_bank

#: Powers of the responses in a small DoRF, of which the first is held out.
DORF = np.linspace(0.3, 0.9, 6)


@pytest.fixture(autouse=True)
def small(monkeypatch):
    """A twentieth of the responses, of ten camera bodies."""
    monkeypatch.setattr(response_bank, "COUNTS", {family: count // 20 for family, count in COUNTS.items()})
    monkeypatch.setitem(response_bank.SPLITS, "held_out_curves", [0])
    monkeypatch.setattr(response_bank, "measured_bodies", lambda data, without: bodies(without))


def bodies(without):
    """Ten bodies; `without` says whether the extreme one is left out."""
    powers = [*np.linspace(0.4, 0.5, 9), *([] if without else [0.1])]
    kinds = ("phone", "compact", "camera")
    return [
        Body(f"b{k}", kinds[k % 3], (ResponseCurve.from_samples(UNIFORM**power),)) for k, power in enumerate(powers)
    ]


@pytest.fixture
def data(tmp_path):
    (tmp_path / "dorf").mkdir()
    scipy.io.savemat(tmp_path / "dorf/201_CRF_data.mat", {"B": UNIFORM ** DORF[:, None]})
    return tmp_path


def test_a_bank_has_its_counts_and_rises_from_0_to_1(data):
    bank = make_bank(data)
    counts = {family: int(bank.members(family).sum()) for family in COUNTS}
    assert counts == {family: count // 20 for family, count in COUNTS.items()}
    assert bank.brightness.dtype == np.float32
    assert (np.diff(bank.brightness, axis=1) >= -1e-7).all()
    np.testing.assert_array_equal(make_bank(data).brightness, bank.brightness)


def test_the_curves_of_dorf_come_first_among_film(data):
    bank = make_bank(data)
    np.testing.assert_allclose(
        bank.brightness[bank.members(Family.FILM)][: len(DORF)], UNIFORM ** DORF[:, None], atol=1e-6
    )


def test_held_out_curves_of_dorf_can_be_left_out(data):
    whole, part = (make_bank(data, without_held_out=each).brightness for each in (False, True))
    first = (UNIFORM ** DORF[0]).astype(np.float32)
    assert np.abs(whole - first).max(axis=1).min() < 1e-6
    assert np.abs(part - first).max(axis=1).min() > 1e-3


def test_a_bank_without_a_fold_holds_nothing_of_its_bodies(data):
    """The body of the fold lifts the shadows as no other does: only the bank with it has such responses."""
    ordinary = [Family.PHONE, Family.COMPACT, Family.CAMERA, Family.EDITED]
    whole, part = (make_bank(data, without=each) for each in (None, "the fold"))
    lifted = [max(bank.brightness[bank.members(family), 10].max() for family in ordinary[:3]) for bank in (whole, part)]
    assert lifted[0] > lifted[1] + 0.1
    np.testing.assert_array_equal(
        whole.brightness[whole.members(Family.FILM)], part.brightness[part.members(Family.FILM)]
    )


def test_a_written_bank_is_read_again(data, tmp_path, monkeypatch):
    bank = make_bank(data)
    write_bank(bank, tmp_path / "bank.npz")
    monkeypatch.setattr("crfnet_core.posterior.responses.BANK_FILE", tmp_path / "bank.npz")
    again = ResponseBank.load.__wrapped__(ResponseBank)
    assert again.families == bank.families
    assert again.brightness.dtype == np.float32
    np.testing.assert_allclose(again.brightness, bank.brightness, atol=0.51 / 65535)
    assert (again.brightness[:, -1] == 1).all()
