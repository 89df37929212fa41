import numpy as np
import pytest

from crfnet_core.response.curve import UNIFORM
from crfnet_core.response.transfer_functions import srgb_encode
from training.data.curves import CurveSource, camera_response, read_base_curves


@pytest.fixture
def bases(tmp_path):
    path = tmp_path / "base_curves.csv"
    rows = ["one,yes,0,0", "one,yes,0.2,0.5", "one,yes,1,1", "two,no,0,0", "two,no,0.5,0.5", "two,no,1,1"]
    path.write_text("name,measured,scene_linear,display_linear\n" + "\n".join(rows) + "\n")
    return read_base_curves(path)


def test_base_curves_go_through_their_nodes(bases):
    assert list(bases) == ["one", "two"]
    assert bases["one"](0.2) == pytest.approx(0.5)
    assert (np.diff(bases["one"](UNIFORM)) > 0).all()


def test_a_straight_base_curve_is_srgb(bases):
    np.testing.assert_allclose(camera_response(bases["two"], 1.0), srgb_encode(UNIFORM), atol=1e-6)


def source(bases, **options):
    dorf = UNIFORM ** np.array([0.4, 0.5, 0.6])[:, None]
    return CurveSource(dorf, tuple(bases.values()), **options)


@pytest.mark.parametrize("camera_fraction", [0.0, 0.5, 1.0])
def test_every_drawn_curve_is_a_response(bases, camera_fraction):
    rng = np.random.default_rng(0)
    drawn = [source(bases, camera_fraction=camera_fraction).draw(rng) for _ in range(50)]
    for curve in drawn:
        assert curve.shape == (1024,)
        assert curve[0] == pytest.approx(0, abs=1e-9)
        assert curve[-1] == pytest.approx(1, abs=1e-9)
        assert (np.diff(curve) >= -1e-9).all()
    assert len({curve.tobytes() for curve in drawn}) > 3 - 2 * camera_fraction


def test_plain_dorf_curves_are_left_as_measured(bases):
    rng = np.random.default_rng(0)
    only_plain = source(bases, camera_fraction=0.0, plain_fraction=1.0)
    measured = {round(0.5004887585532747**exponent, 4) for exponent in (0.4, 0.5, 0.6)}
    assert {round(float(only_plain.draw(rng)[512]), 4) for _ in range(30)} == measured
