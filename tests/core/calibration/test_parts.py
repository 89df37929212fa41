import numpy as np

from crfnet_core.calibration.alignment import chain_of_shifts, rank_image


def texture(height=160, width=200, seed=0):
    """A smooth random texture, which repeats at its edges."""
    spectrum = np.fft.rfft2(np.random.default_rng(seed).standard_normal((height, width)))
    rows, columns = np.fft.fftfreq(height)[:, None], np.fft.rfftfreq(width)[None]
    return np.fft.irfft2(spectrum * np.exp(-200 * (rows**2 + columns**2)), s=(height, width))


def test_shifts_add_up_along_the_exposures():
    """Frames 2, 0, 1 from dark to bright: 0 is the reference, its neighbors are compared with it."""
    image = texture()
    ranks = [rank_image(np.roll(image, shift, axis=(0, 1))) for shift in ((0, 0), (3, 2), (-4, 0))]
    assert chain_of_shifts(ranks, [2, 0, 1], stride=2) == ((0, 0), (6, 4), (-8, 0))
