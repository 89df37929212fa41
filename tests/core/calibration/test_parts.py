import numpy as np

from crfnet_core.calibration.alignment import align


def test_shifts_add_up_along_the_exposures():
    """Frames 2, 0, 1 from dark to bright: 0 is the reference, its neighbors are compared with it."""
    rows, columns = np.fft.fftfreq(160)[:, None], np.fft.rfftfreq(200)[None]
    spectrum = np.fft.rfft2(np.random.default_rng(0).standard_normal((160, 200)))
    texture = np.fft.irfft2(spectrum * np.exp(-200 * (rows**2 + columns**2)), s=(160, 200))  # repeats at its edges
    moved = [np.roll(texture, shift, axis=(0, 1)) for shift in ((0, 0), (3, 2), (-4, 0))]
    pictures = [picture[..., None].repeat(3, axis=2) for picture in moved]
    cut, shifts = align(pictures, [2, 0, 1])
    assert shifts.tolist() == [[0, 0], [3, 2], [-4, 0]]
    assert all(np.array_equal(cut[0], picture) for picture in cut[1:])
