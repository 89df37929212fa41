import numpy as np
import pytest

from training.synthesis.sensor import Demosaicing, Sensor, demosaiced


@pytest.fixture
def planes():
    y, x = np.mgrid[:61, :61] / np.float32(61)
    light = [0.2 + 0.5 * x, 0.3 + 0.3 * y, 0.4 + 0.2 * x * y]
    return [np.stack([plane, 0.5 * plane]).astype(np.float32) for plane in light]


def mosaic_of(planes):
    red, green, blue = planes
    mosaic = green.copy()
    mosaic[:, ::2, ::2], mosaic[:, 1::2, 1::2] = red[:, ::2, ::2], blue[:, 1::2, 1::2]
    return mosaic


@pytest.mark.parametrize("side", [60, 61])
@pytest.mark.parametrize("method", list(Demosaicing))
def test_demosaicing_keeps_what_was_measured_and_finds_smooth_light_again(planes, method, side):
    planes = [plane[:, :side, :side] for plane in planes]
    filled = demosaiced(mosaic_of(planes), method)
    np.testing.assert_allclose(filled[0][:, ::2, ::2], planes[0][:, ::2, ::2], atol=1e-6)
    np.testing.assert_allclose(filled[2][:, 1::2, 1::2], planes[2][:, 1::2, 1::2], atol=1e-6)
    inside = np.s_[:, 3:-3, 3:-3]
    for found, plane in zip(filled, planes, strict=True):
        np.testing.assert_allclose(found[inside], plane[inside], atol=2e-3)


def test_the_matrix_undoes_crosstalk_and_clips_what_it_makes_negative(planes):
    sensor = Sensor(crosstalk=0.4)
    for recorded, plane in zip(sensor.record(planes, np.random.default_rng(0)), planes, strict=True):
        np.testing.assert_allclose(recorded, plane, atol=1e-5)
    red = [planes[0], 0.1 * planes[0], 0.1 * planes[0]]
    pushed = Sensor(saturation=2.0).record(red, np.random.default_rng(0))
    assert (pushed[0] > red[0]).all()
    assert (pushed[1] == 0).all()


def test_channels_clip_together_or_where_the_sensor_does():
    bright = [np.full((1, 8, 8), 3, np.float32)] * 3
    together = Sensor(gains=(2, 1, 1.5), white=1.2).record(bright, np.random.default_rng(0))
    apart = Sensor(gains=(2, 1, 1.5), white=1.2, clips_apart=True).record(bright, np.random.default_rng(0))
    assert [plane[0, 0, 0] for plane in together] == pytest.approx([1.2, 1.2, 1.2])
    assert [plane[0, 0, 0] for plane in apart] == pytest.approx([2.4, 1.2, 1.8])


def test_noise_has_the_variance_of_the_sensor_and_grows_with_the_gain():
    level = [np.full((1, 200, 200), 0.25, np.float32)] * 3
    red, green, _ = Sensor(shot_noise=4e-4, read_noise=0.01, gains=(2, 1, 1)).record(level, np.random.default_rng(0))
    assert green.std() == pytest.approx(np.sqrt(0.25 * 4e-4 + 1e-4), rel=0.05)
    assert red.std() == pytest.approx(np.sqrt(0.25 * 8e-4 + 4e-4), rel=0.05)
