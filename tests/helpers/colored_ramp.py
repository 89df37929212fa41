"""The picture in the HEIC and AVIF files of the tests."""

import numpy as np


def colored_ramp(bits, *, height=48, width=64):
    """Return RGB codes of `bits` bits, shape (height, width, 3): red grows to the right, green down, blue both ways."""
    across, down = np.linspace(0, 1, width)[None], np.linspace(0, 1, height)[:, None]
    red, green, blue = across * np.ones_like(down), down * np.ones_like(across), (across + down) / 2
    codes = np.rint(np.stack([red, green, blue], axis=-1) * (2**bits - 1))
    return codes.astype(np.uint8 if bits == 8 else np.uint16)
