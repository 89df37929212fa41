import numpy as np

from crfnet_core.calibration.alignment import chain_of_shifts, rank_image


def test_shifts_add_up_along_the_exposures():
    """Frames 2, 0, 1 from dark to bright: 0 is the reference, its neighbors are compared with it."""
    rows, columns = np.fft.fftfreq(160)[:, None], np.fft.rfftfreq(200)[None]
    spectrum = np.fft.rfft2(np.random.default_rng(0).standard_normal((160, 200)))
    texture = np.fft.irfft2(spectrum * np.exp(-200 * (rows**2 + columns**2)), s=(160, 200))  # repeats at its edges
    ranks = [rank_image(np.roll(texture, shift, axis=(0, 1))) for shift in ((0, 0), (3, 2), (-4, 0))]
    assert chain_of_shifts(ranks, [2, 0, 1], stride=2) == ((0, 0), (6, 4), (-8, 0))
