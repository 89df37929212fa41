import numpy as np
import pytest

from crfnet_core.response.curve import UNIFORM
from training.synthesis.camera import apply_response
from training.synthesis.camera_draws import WINDOWS, FrameKind, Frames, draw_development
from training.synthesis.development import Development, ToneMapping, develop, hue_kept, looked_up, point_sampled

CURVE = UNIFORM**0.45


@pytest.fixture
def light():
    """Exposed light of two frames of 454 x 454 samples, in color."""
    rng, (y, x) = np.random.default_rng(5), np.mgrid[:454, :454] / 150
    frame = np.exp(np.sin(3 * x) + np.cos(2 * y) + 0.1 * rng.standard_normal((454, 454)))[:, :, None] * [0.3, 0.2, 0.15]
    return np.stack([frame, frame[:, ::-1]]).astype(np.float32)


def test_without_steps_only_the_response_and_rounding_are_left(light):
    windows = develop(light[:, :227, :227], CURVE, Development(), np.random.default_rng(0))
    expected = apply_response(light[:, :227, :227], CURVE) * 255
    assert np.abs(windows - expected).max() < 0.6  # a half, and what the finer table adds


def test_windows_of_a_frame_are_every_second_sample_from_different_ones_on():
    codes = np.random.default_rng(0).integers(0, 256, (2, 454, 454, 3), dtype=np.uint8)
    windows = point_sampled(codes, 2, 0, np.random.default_rng(0))
    assert windows.shape == (4, 227, 227, 3)
    np.testing.assert_array_equal(windows[0], codes[0, ::2, ::2])
    np.testing.assert_array_equal(windows[2], codes[0, 1::2, 1::2])


def test_a_hue_preserving_curve_is_the_response_of_the_outer_channels(light):
    planes = [np.ascontiguousarray(light[..., k]) for k in range(3)]
    curve = CURVE**2 * (3 - 2 * CURVE)
    kept, apart = hue_kept(planes, curve), [looked_up(plane, curve) for plane in planes]
    order = np.argsort(light, axis=-1)
    for place in (0, 2):
        chosen = order[..., place][..., None]
        first, second = (np.take_along_axis(np.stack(one, axis=-1), chosen, axis=-1) for one in (kept, apart))
        np.testing.assert_allclose(first, second, atol=2e-3)
    assert np.abs(kept[1] - apart[1]).max() > 0.005


def test_tone_mapping_evens_out_the_large_scale_contrast(light):
    planes = [np.ascontiguousarray(light[..., k]) for k in range(3)]
    gain = ToneMapping(strength=0.3).gain(planes)
    assert gain.shape == planes[0].shape
    assert np.log2(planes[1] * gain).std() < np.log2(planes[1]).std()
    assert np.abs(np.diff(np.log2(gain), axis=1)).max() < 0.1


@pytest.mark.parametrize("kind", [kind for kind in FrameKind if kind is not FrameKind.PLAIN])
def test_drawn_cameras_give_windows_that_repeat_with_the_seed_and_leave_the_light(light, kind):
    for seed in range(3):
        frames = Frames.draw(kind, np.random.default_rng(seed))
        exposed = np.tile(light[:1], (frames.count, 2, 2, 1))[:, : frames.side, : frames.side]
        before = exposed.copy()
        first, second = (
            develop(exposed, CURVE, draw_development(kind, rng), rng, windows=WINDOWS)
            for rng in (np.random.default_rng(seed), np.random.default_rng(seed))
        )
        assert first.shape == (WINDOWS, 227, 227, 3)
        assert first.dtype == np.uint8
        assert len(np.unique(first)) > 100
        np.testing.assert_array_equal(first, second)
        np.testing.assert_array_equal(exposed, before)
