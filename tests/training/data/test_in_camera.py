import numpy as np
import pytest

from crfnet_core.posterior import IN_CAMERA
from crfnet_core.response.curve import UNIFORM, ResponseCurve
from training.data.in_camera import InCameraResponses, log_irradiance
from training.data.real_photographs import Body


def body(key, kind, *powers):
    """A camera body; a response for each of its stacks, as a power of irradiance."""
    return Body(key, kind, tuple(ResponseCurve.from_samples(UNIFORM**power) for power in powers))


@pytest.fixture(scope="module")
def bodies():
    """Phones lift shadows more than cameras do; one camera has many stacks."""
    rng = np.random.default_rng(0)
    phones = [body(f"p{k}", "phone", 0.36 + rng.normal(0, 0.01)) for k in range(6)]
    compacts = [body(f"c{k}", "compact", 0.42 + rng.normal(0, 0.01)) for k in range(6)]
    cameras = [body(f"d{k}", "camera", 0.48 + rng.normal(0, 0.01)) for k in range(6)]
    return [*phones, *compacts, *cameras]


def middle(curves):
    return np.log(curves[..., 512]) / np.log(UNIFORM[512])


def test_kinds_have_their_own_centers_and_spread(bodies):
    found = InCameraResponses.from_bodies(bodies)
    assert set(found.centers) == set(IN_CAMERA)
    drawn = {kind: middle(found.draw(kind, 300, np.random.default_rng(1))) for kind in IN_CAMERA}
    centers = [np.median(drawn[kind]) for kind in ("phone", "compact", "camera")]
    assert centers == sorted(centers)
    assert centers == pytest.approx([0.36, 0.42, 0.48], abs=0.02)
    assert 0.003 < drawn["phone"].std() < 0.04


def test_a_body_counts_once_however_many_stacks_it_has(bodies):
    many = [*bodies, body("x", "camera", *[0.6] * 20)]
    one = [*bodies, body("x", "camera", 0.6)]
    for kind in IN_CAMERA:
        np.testing.assert_allclose(
            InCameraResponses.from_bodies(many).centers[kind], InCameraResponses.from_bodies(one).centers[kind]
        )


def test_one_odd_body_hardly_moves_the_center_of_its_kind(bodies):
    before = InCameraResponses.from_bodies(bodies).centers["camera"]
    after = InCameraResponses.from_bodies([*bodies, body("odd", "camera", 0.9)]).centers["camera"]
    odd = log_irradiance(ResponseCurve.from_samples(UNIFORM**0.9))
    assert abs(after[512] - before[512]) < 0.1 * abs(odd[512] - before[512])
