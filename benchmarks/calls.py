"""What calls from Python cost: an estimate beside the decoding, its memory, a frame in memory beside its copy."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict
from functools import partial
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from benchmarks.costs import Figure, cost_of_call, cost_of_command, medians, ratio
from benchmarks.pictures import made, make_photograph
from crfnet.luts.lut1d import inverse_response_lut
from crfnet_core import ResponseCurve, ResponseNetwork, estimate_response, read_photo

#: Rows, columns and channels of a 4K frame, and of the photograph.
FRAME, PHOTOGRAPH = (2160, 3840, 3), (4000, 6000, 3)

ESTIMATE = """
import sys
from crfnet_core import ResponseNetwork, estimate_response, read_photo
estimate_response(read_photo(sys.argv[1]), network=ResponseNetwork.load())
"""


def estimate_in_memory(folder: Path, runs: int) -> Iterator[Figure]:
    """Yield what an estimate costs beside the decoding of its photograph, and its memory beyond the codes."""
    path = made(make_photograph, folder / "photo.jpg")
    cost = medians({"": partial(cost_of_command, ["python", "-c", ESTIMATE, str(path)])}, runs)[""]
    codes = float(np.prod(PHOTOGRAPH)) / 1e6
    details = asdict(cost) | {"codes": codes}
    yield Figure("peak memory of an estimate over its codes", "MB", cost.memory - codes, "at most 200", details)
    network, photo = ResponseNetwork.load(), read_photo(path)
    estimate_response(photo, network=network)  # the bank of responses is loaded once
    works: dict[str, Callable[[], object]] = {
        "estimate_response": partial(estimate_response, photo, network=network),
        "decoding with OpenImageIO": partial(_decode, path),
    }
    costs = medians({name: partial(cost_of_call, work) for name, work in works.items()}, 2 * runs)
    yield ratio("estimate_response, model loaded, against decoding that JPEG", "at most 1.0", costs)


def frame_in_memory(_: Path, runs: int) -> Iterator[Figure]:
    """Yield what the LUT, the response and its inverse cost on a frame of float32, beside a copy of it."""
    curve, pixels = ResponseCurve.gamma(), np.random.default_rng(0).random(FRAME, dtype=np.float32)
    copy, lut = np.zeros_like(pixels), inverse_response_lut(curve)
    works: dict[str, Callable[[], object]] = {
        "np.copyto": partial(np.copyto, copy, pixels),
        "Lut1D.apply": partial(lut.apply, pixels),
        "inverse": partial(curve.inverse, pixels),
        "forward": partial(curve.forward, pixels),
    }
    costs = medians({name: partial(cost_of_call, work) for name, work in works.items()}, runs)
    for name, limit in (("Lut1D.apply", "at most 1.5"), ("inverse", ""), ("forward", "")):
        pair = {each: costs[each] for each in (name, "np.copyto")}
        yield ratio(f"one 4K float frame in memory, {name}, against np.copyto", limit, pair)


def _decode(path: Path) -> None:
    """Decode a photograph as OpenImageIO does by itself."""
    source = oiio.ImageInput.open(str(path))
    assert source is not None
    source.read_image(0, 0, 0, 3, "uint8")
    source.close()
