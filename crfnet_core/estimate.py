"""From one photograph, or several of one camera, to its response and how far to trust it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from crfnet_core.emor import EmorBasis
from crfnet_core.errors import PhotoError
from crfnet_core.network import ResponseNetwork, Verdict, pooling
from crfnet_core.photo import Photo
from crfnet_core.response import ResponseCurve
from crfnet_core.types import Float32Array, Float64Array, Progress
from crfnet_core.windows import FULL_COVERAGE, Window, cut_windows, select_windows

#: Share of samples at the ends of the range above which a photograph counts as mostly clipped.
MOSTLY_CLIPPED = 0.5


@dataclass(frozen=True)
class WindowEstimate:
    """One window's part in an estimate.

    Parameters
    ----------
    photo : int
        Which of the photographs the window was cut from.
    window : Window
        Where it lies and how much of the range it covers.
    weights : ndarray, float64, shape (11,)
        The EMoR weights that the network gave for it.
    expected_error : float
        The E_est that the network expects of it.
    kept : bool
        Whether it agrees with the others; an outlier enters no average of a network that does not pool by itself.
    """

    photo: int
    window: Window
    weights: Float64Array
    expected_error: float
    kept: bool


@dataclass(frozen=True)
class ResponseEstimate:
    """A response, its evidence, and how far to trust it.

    Parameters
    ----------
    curve : ResponseCurve
        The estimated response.
    weights : ndarray, float64, shape (11,)
        Its EMoR weights, before it was made monotone.
    windows : tuple of WindowEstimate
        What each window said.
    spread : float
        RMS distance of the kept windows' estimates from their mean, in units of E_est.
    uncertainty : float
        The E_est to be expected of this estimate.
    band : ndarray, float64, shape (2, 1024)
        Lower and upper end of the 90 % band around the response.
    warnings : tuple of str
        What makes a poor estimate likely, in words.
    model : str
        Name and hash of the network.
    photos : tuple of str
        File names of the photographs.
    """

    curve: ResponseCurve
    weights: Float64Array
    windows: tuple[WindowEstimate, ...]
    spread: float
    uncertainty: float
    band: Float64Array
    warnings: tuple[str, ...]
    model: str
    photos: tuple[str, ...]

    @property
    def verdict(self) -> Verdict:
        """The uncertainty in words."""
        return Verdict.of(self.uncertainty)


def estimate_response(
    photos: Photo | Iterable[Photo],
    *,
    network: ResponseNetwork,
    windows: int = 10,
    seed: int = 0,
    coverage: int = FULL_COVERAGE,
    progress: Progress | None = None,
) -> ResponseEstimate:
    """Estimate the response of the camera that took one or several photographs.

    The network pools the windows of all photographs into one response. Where it cannot, as that of the CRF-net paper,
    every window's own estimate counts: those far from the others are removed and the rest averaged.

    Parameters
    ----------
    photos : Photo or iterable of Photo
        Photographs of one camera with the same settings; an iterator needs the memory of one photograph only.
    network : ResponseNetwork
        See `ResponseNetwork.load`.
    windows : int
        Windows of each photograph.
    seed : int
        Of the choice of windows.
    coverage : int
        Code values, of 256, that a window should hold; see `select_windows`.
    progress : callable, optional
        Called with (done, total) after every window.

    Raises
    ------
    PhotoError
        If there is no photograph, or one is smaller than a window.
    """
    photos = (photos,) if isinstance(photos, Photo) else photos
    evidence = [_evidence(photo, windows, seed, coverage) for photo in photos]
    if not evidence:
        raise PhotoError("there is no photograph to analyse; give at least one")
    chosen = [(i, window) for i, part in enumerate(evidence) for window in part.windows]
    samples = np.concatenate([part.samples for part in evidence])
    inputs = network.inputs(samples, progress=progress)
    predictions = network.predict(inputs, progress=progress)
    kept = pooling.inliers(predictions.weights)
    answer = predictions.pooled or pooling.robust_mean(predictions, kept)
    curve = ResponseCurve.from_samples(EmorBasis.load().reconstruct(answer.weights))
    spread = pooling.spread(predictions.weights[kept])
    uncertainty = network.config.uncertainty_model.uncertainty(answer.expected_error, spread)
    return ResponseEstimate(
        curve=curve,
        weights=answer.weights,
        windows=tuple(
            WindowEstimate(i, window, predictions.weights[n], float(predictions.expected_errors[n]), bool(kept[n]))
            for n, (i, window) in enumerate(chosen)
        ),
        spread=spread,
        uncertainty=uncertainty,
        band=network.config.uncertainty_model.band(curve, uncertainty),
        warnings=_warnings(evidence, samples),
        model=network.config.label,
        photos=tuple(part.name for part in evidence),
    )


@dataclass(frozen=True)
class _Evidence:
    """What stays of a photograph once its windows are cut: name, whether it is gray, windows and their samples."""

    name: str
    is_gray: bool
    windows: tuple[Window, ...]
    samples: Float32Array


def _evidence(photo: Photo, count: int, seed: int, coverage: int) -> _Evidence:
    """Return the windows of one photograph; an error names its file."""
    try:
        windows = select_windows(photo.pixels, count=count, seed=seed, coverage=coverage)
    except PhotoError as problem:
        raise PhotoError(f"{photo.path}: {problem}") from None
    return _Evidence(photo.path.name, photo.is_gray, windows, cut_windows(photo.pixels, windows))


def _warnings(evidence: Sequence[_Evidence], samples: Float32Array) -> tuple[str, ...]:
    """Return what makes a poor estimate likely, in words."""
    warnings = []
    if not any(window.covers_range for part in evidence for window in part.windows):
        warnings.append("no window covers the range of brightness: expect a poor estimate")
    if all(part.is_gray for part in evidence):
        warnings.append("gray photograph: one channel says less than three, and it may be a mixture of channels")
    if np.mean((samples <= 0.5 / 255) | (samples >= 254.5 / 255)) > MOSTLY_CLIPPED:
        warnings.append("mostly clipped: take a photograph with another exposure")
    return tuple(warnings)
