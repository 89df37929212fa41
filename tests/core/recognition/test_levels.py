import numpy as np
import pytest

from crfnet_core.photograph.recognition import Levels


def flat(*shares, size=1000):
    """Return a picture of gray values, each with a share of the pixels."""
    values = np.concatenate([np.full(round(share * size * size), value) for value, share in shares])
    return np.repeat(values.reshape(size, size, 1), 3, axis=2).astype(np.float32)


def test_the_picture_is_not_changed_and_a_large_one_is_thinned():
    pixels = flat((0.25, 0.5), (0.75, 0.5), size=2000)
    before = pixels.copy()
    assert Levels.from_pixels(pixels).histogram.sum() <= 3_000_000
    np.testing.assert_array_equal(pixels, before)


def test_several_pictures_count_the_same_whatever_their_size():
    pictures = flat((0.25, 1.0), size=100), flat((0.75, 1.0), size=500)
    joint = Levels.joint([Levels.from_pixels(picture) for picture in pictures])
    assert joint.histogram[:512].sum() / joint.histogram.sum() == pytest.approx(0.5)
    assert (joint.black, joint.white) == pytest.approx((0.25, 0.75), abs=1 / 1023)


def test_all_8_and_10_bit_codes_have_bins_of_their_own():
    for largest in (255, 1023):
        pixels = np.repeat((np.arange(largest + 1) / largest).astype(np.float32)[None, :, None], 3, axis=2)
        assert (Levels.from_pixels(pixels).histogram > 0).sum() == largest + 1
