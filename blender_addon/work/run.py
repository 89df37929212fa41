# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run does outside Blender's data: estimate, and write files. It may go on in any thread."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from crfnet_core import CRFNetError, ResponseCurve, ResponseEstimate, ResponseNetwork, estimate_response, read_photo
from ocio import report as describe
from ocio.luts.lut1d import inverse_response_lut
from ocio.plates.frames import find_frames, sample_frames

from ..ui.gather import Request
from . import encoding_check, writers
from .background import Progress

#: The linear value of middle gray.
MIDDLE_GRAY = 0.18


@dataclass(frozen=True)
class Outcome:
    """What a run found and wrote.

    Parameters
    ----------
    estimate : ResponseEstimate
        The response.
    lines : tuple of str
        What is to be said of it.
    exposure : float
        Stops to be added after the inverse response.
    files : Baked, Installed, Exported or None
        What was written.
    """

    estimate: ResponseEstimate
    lines: tuple[str, ...]
    exposure: float
    files: writers.Baked | writers.Installed | writers.Exported | None


def run(request: Request, progress: Progress) -> Outcome:
    """Return what came of a request.

    Parameters
    ----------
    request : Request
        What to do.
    progress : callable
        Called with (done, total); what it raises ends the run.

    Raises
    ------
    CRFNetError, AddonError
        If the plate, the model or a folder is not as it should be; no file is left half-written then.
    """
    estimate = request.estimate or estimate_plate(request, progress)
    exposure = anchored_exposure(estimate.curve, request)
    lut = inverse_response_lut(estimate.curve, length=request.lut_length, comments=describe.provenance(estimate))
    write = writers.WRITERS.get(request.apply)
    files = write(request, lut, exposure, progress) if write else None
    return Outcome(estimate, tuple(describe.verdict_lines(estimate)), exposure, files)


def estimate_plate(request: Request, progress: Progress) -> ResponseEstimate:
    """Return the response of a plate: of its file, or of several of its frames.

    Raises
    ------
    AddonError
        If the footage is logarithmic or linear and the request does not insist.
    CRFNetError
        If a file or the model cannot be read.
    """
    progress(0, 1)
    files = sample_frames(find_frames(request.plate.file))
    if not request.force:
        encoding_check.check_is_encoded(request.plate, files[0], request.base_config)
    network = _network(request.model, request.threads)
    return estimate_response(map(read_photo, files), network=network, progress=progress)


def anchored_exposure(curve: ResponseCurve, request: Request) -> float:
    """Return the stops to be added after the inverse response, so that the anchor comes where it belongs."""
    if request.anchor != "GRAY":
        return request.exposure
    irradiance = float(curve.inverse(request.gray))
    if irradiance <= 0:
        raise CRFNetError(f"a brightness of {request.gray:g} is black in this response; anchor a brighter gray")
    return float(np.log2(MIDDLE_GRAY / irradiance)) + request.exposure


@lru_cache(maxsize=1)
def _network(model: Path | None, threads: int) -> ResponseNetwork:
    """Return the network; the last one stays loaded."""
    return ResponseNetwork.load(model, threads=threads)
