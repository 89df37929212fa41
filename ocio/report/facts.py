"""Facts about photographs and estimates in words, for the command, JSON, LUT files and the sheet."""

from dataclasses import dataclass

import numpy as np

from crfnet_core.errors import beside_limits
from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.posterior.verdict import USABLE_STOPS
from crfnet_core.response.metrics import brightness_percent


@dataclass(frozen=True)
class PhotoEntry:
    """A photograph in the document of an estimate, and in words."""

    name: str
    width: int
    height: int
    bit_depth: int
    has_gain_map: bool = False  # so that the base picture was read

    def __str__(self) -> str:
        """Return one line for people."""
        base = "; the base picture of an HDR photograph, without its gain map" if self.has_gain_map else ""
        return f"{self.name}: {self.width} x {self.height}, {self.bit_depth} bits{base}"


@dataclass(frozen=True)
class Phrases:
    """The phrases of a face: remedies behind the advice about an estimate that is not to be trusted."""

    calibrate: str = ", or run crfnet calibrate"
    state_device: str = ", or say with --taken-with which kind of camera took it, if it is a photograph"
    has_e_est: bool = True  # whether errors are also given as E_est, the figure of the literature


COMMAND = Phrases()


def curve_error_words(estimate: ResponseEstimate, phrases: Phrases = COMMAND) -> str:
    """Return in words how far the curve is expected to be off."""
    percent = brightness_percent(estimate.uncertainty)
    figure = f" (E_est {estimate.uncertainty:.2f})" if phrases.has_e_est else ""
    return f"{percent:.1f} % of the brightness range{figure}"


def shape_error_words(estimate: ResponseEstimate) -> str:
    """Return in words how far the shape of the linear light is expected to be off; empty if that is not known."""
    shape = estimate.shape_uncertainty  # NaN in estimates that an earlier version of the add-on stored
    return f"{beside_limits(shape, USABLE_STOPS)} stop" if np.isfinite(shape) else ""


def expected_errors(estimate: ResponseEstimate) -> str:
    """Return both expected errors in a few words, stops first."""
    return ", ".join(filter(None, [shape_error_words(estimate), curve_error_words(estimate)]))


def basis(estimate: ResponseEstimate) -> str:
    """Return the stored camera, or the prior and what the files say of their making; empty if it is not known."""
    if estimate.camera:
        return f'Response of the camera "{estimate.camera.name}", {estimate.camera.basis}'
    if not estimate.prior:
        return ""
    return f"Prior: {estimate.prior}; {_metadata_words(estimate)}"


def agreeing(estimate: ResponseEstimate) -> str:
    """Return in words how many windows agree with the others."""
    return f"{sum(window.kept for window in estimate.windows)} of {len(estimate.windows)} analyzed windows agree"


def provenance(estimate: ResponseEstimate) -> tuple[str, ...]:
    """Return the comment lines of LUT files: what the LUT is, its photographs, its model, and how far to trust it."""
    kind = estimate.likely_kind
    lines = (
        "Inverse camera response: encoded brightness in, relative scene-linear irradiance out",
        f"Photographs: {', '.join(estimate.photos)}" if estimate.photos else "",
        f"Model: {estimate.model}" if estimate.model and not estimate.camera else "",
        f"Verdict: {estimate.verdict}, expected error {expected_errors(estimate)}",
        ". ".join(filter(None, [f"Most likely {kind}" if kind else "", basis(estimate)])),
    )
    return tuple(filter(None, lines))


def _metadata_words(estimate: ResponseEstimate) -> str:
    """Return what the metadata and who knows the camera say of the photographs; of several that differ, the first."""
    first, *others = [", ".join(origin.words) for origin in estimate.origins] or [""]
    if not first:
        return "no metadata used"
    differing = sum(words != first for words in others)
    more = f" (the first of {1 + len(others)} photographs; in {differing} it differs)" if differing else ""
    if estimate.origins[0].has_stated_device:
        who = "you and the file say" if len(estimate.origins[0].words) > 1 else "you say"
        return f"{who}: {first}{more}"
    return f"metadata: {first}{more}"
