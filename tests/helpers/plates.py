"""Plates to linearize, and the results."""

import numpy as np
import OpenImageIO as oiio

from crfnet.luts.lut1d import inverse_response_lut
from crfnet.movies.source import find_source
from crfnet.options import PlateOptions
from crfnet.plates.linear import linear_targets, linearize_plates
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.images import read_image, write_image

#: The inverse of gamma 2.2, with provenance.
LUT = inverse_response_lut(ResponseCurve.gamma(2.2), comments=("photograph plate.jpg", "model test"))

#: Random 8-bit codes, shape (70, 90, 4).
SMALL = np.random.default_rng(0).integers(0, 256, (70, 90, 4), dtype=np.uint8)


def linearize(plates, out, lut, *, frames=None, workers=None, progress=None, **options):
    """Linearize the file, the sequence or the movie `plates` into `out`; `options` are as of `PlateOptions`."""
    sequence = find_source(plates, frames)
    targets = linear_targets(out, sequence)
    return linearize_plates(sequence, targets, lut, PlateOptions(**options), workers=workers, progress=progress)


def write_sequence(folder, numbers, name="plate.{:04d}.png"):
    """Write a different frame for every number and return the pattern of the default name."""
    for number in numbers:
        write_image(folder / name.format(number), np.roll(SMALL[..., :3], number, axis=0))
    return folder / "plate.%04d.png"


def read_exr(path):
    """Return the pixels of an EXR as float32, shape (H, W, C), and its header."""
    return read_image(path), oiio.ImageBuf(str(path)).nativespec()


def attributes(spec):
    """Return the metadata of a header by name."""
    return {attribute.name: attribute.value for attribute in spec.extra_attribs}
