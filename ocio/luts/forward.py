"""The response itself as a LUT, from linear light to code values: the inverse of an inverse response."""

from dataclasses import replace

import numpy as np

from .lut1d import Lut1D, strictly_increasing
from .rgb_lut import AnyLut, lut_of_channels

#: How the comment begins that says that a LUT is an inverse response.
INVERSE_COMMENT = "Inverse camera response"

#: Lengths of a response as a LUT: the 1023 pieces of an estimated one, or these divided, as power functions need.
LENGTHS = (1024, 4093, 16369, 65473)

#: Largest error of a response as a LUT, in codes of 10 bits; the shortest length that keeps it is taken.
MOST_ERROR = 0.1


def forward_lut(lut: AnyLut) -> AnyLut:
    """Return the response, from the light of all codes to codes, of a LUT of its inverse whose domain holds [0, 1]."""
    for length in LENGTHS:
        forward = _sampled(lut, length)
        if round_trip_error(lut, forward, bits=10) <= MOST_ERROR:
            break
    errors = " and ".join(f"{round_trip_error(lut, forward, bits=bits):.2g} of {bits} bits" for bits in (8, 10))
    comments = (
        "Camera response: relative scene-linear irradiance in, encoded brightness out; light above white is clipped",
        f"Gives every code back from its linear light within, in codes, {errors}",
        *(comment for comment in lut.comments if not comment.startswith(INVERSE_COMMENT)),
    )
    return replace(forward, comments=comments)


def round_trip_error(lut: AnyLut, forward: AnyLut, *, bits: int) -> float:
    """Return the largest error, in codes of 8 to 16 bits, of all codes through an inverse response and back."""
    largest = 2**bits - 1
    codes = np.arange(largest + 1, dtype=np.float32) / np.float32(largest)  # float32 between the LUTs, as in hosts
    errors = [
        np.abs(back.apply(there.apply(codes)) - codes).max()
        for there, back in zip(lut.channels, forward.channels, strict=True)
    ]
    return float(np.max(errors) * largest)


def _sampled(lut: AnyLut, length: int) -> AnyLut:
    """Return the inverse of a LUT at uniform inputs; the channels get one domain."""
    ends = np.array([channel.apply(np.array([0.0, 1.0])) for channel in lut.channels])  # (1 or 3, 2)
    domain = float(ends[:, 0].min()), float(ends[:, 1].max())
    light = np.linspace(*domain, length)
    tables = [strictly_increasing(np.clip(channel.apply_inverse(light), 0, 1)) for channel in lut.channels]
    return lut_of_channels([Lut1D(table, domain) for table in tables])
