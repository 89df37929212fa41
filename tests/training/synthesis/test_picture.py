import io

import numpy as np
import pytest
from PIL import Image

from training.synthesis.picture import LUMA, Finish, Jpeg, Sharpening, smoothed, split


@pytest.fixture
def codes():
    rng, (y, x) = np.random.default_rng(3), np.mgrid[:64, :64]
    frame = np.stack([2 * x + 60, 2 * y + 50, x + y + 40], axis=-1) + rng.integers(-6, 7, (64, 64, 1))
    return np.stack([frame, frame[::-1]]).astype(np.uint8)


def luma(planes):
    return sum(weight * plane for weight, plane in zip(LUMA, planes, strict=True))


@pytest.mark.parametrize(("scale", "quality"), [(1.0, 50), (0.2, 90), (0.1, 95)])
def test_tables_without_flatness_are_those_of_the_encoder_of_that_quality(scale, quality):
    file = io.BytesIO()
    Image.new("RGB", (8, 8)).save(file, "JPEG", quality=quality)
    expected = Image.open(file).quantization
    for number, table in enumerate(Jpeg(scale).tables):
        assert np.abs(np.array(table) - expected[number]).max() <= 1


def test_chroma_gain_and_blur_keep_luma(codes):
    planes = split(codes)
    for finish in (Finish(chroma_gain=1.3), Finish(chroma_blur=5), Finish(chroma_gain=0)):
        np.testing.assert_allclose(luma(finish.applied(planes)), luma(planes), atol=1e-5)
    gray = Finish(chroma_gain=0).applied(planes)
    np.testing.assert_allclose(gray[0], gray[2], atol=1e-6)


def test_smoothing_takes_noise_out_and_leaves_edges():
    rng = np.random.default_rng(0)
    step = np.repeat([[0.2, 0.8]], 32, axis=1).astype(np.float32)  # (1, 64)
    picture = np.tile(step, (64, 1))[None]
    noisy = picture + 0.005 * rng.standard_normal(picture.shape, dtype=np.float32)
    cleaned = smoothed(noisy, 0.02)
    assert cleaned[0, :, 4:28].std() < 0.5 * noisy[0, :, 4:28].std()
    assert np.abs(cleaned - picture).max() < 0.03


def test_sharpening_overshoots_at_edges_up_to_its_limit_and_leaves_small_detail():
    picture = np.tile(np.repeat([0.3, 0.7], 16), (32, 1))[None].astype(np.float32)
    added = Sharpening(amount=1.5, radius=1.0, limit=0.05).added(picture)
    assert added.max() == pytest.approx(0.05)
    assert added[0, 16, 16] > 0 > added[0, 16, 15]
    weak = 0.5 + 0.001 * (picture - 0.5)
    assert (Sharpening(amount=1.5, threshold=0.01).added(weak) == 0).all()
