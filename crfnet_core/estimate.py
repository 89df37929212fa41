"""The method: from one photograph, or several of one camera, to its response and how far to trust it.

`estimate_response` is the whole of it on one screen; docs/METHOD.md explains each step with its equations.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from crfnet_core.emor import EmorBasis
from crfnet_core.errors import PhotoError
from crfnet_core.network import Predictions, ResponseNetwork, Verdict, pooling
from crfnet_core.photo import Photo
from crfnet_core.response import ResponseCurve
from crfnet_core.types import BoolArray, Float32Array, Float64Array, Progress
from crfnet_core.windows import FULL_COVERAGE, WINDOWS_PER_PHOTOGRAPH, Window, cut_windows, select_windows

#: Fraction of samples at the ends of the range above which a photograph counts as mostly clipped.
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
        The EMoR weights that the network predicts from this window alone.
    expected_error : float
        The E_est that the network expects of them.
    kept : bool
        Whether the window agrees with the others (`pooling.inliers`). Without learned pooling, only such windows count.
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
        What the network says of each window.
    spread : float
        RMS distance of the kept windows' weights from their mean, in units of E_est.
    uncertainty : float
        The expected E_est of this estimate.
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
    windows: int = WINDOWS_PER_PHOTOGRAPH,
    seed: int = 0,
    coverage: int = FULL_COVERAGE,
    progress: Progress | None = None,
) -> ResponseEstimate:
    """Estimate the response of the camera that took one or several photographs.

    Windows are cut from every photograph. The network reads them, or statistics that are counted in them, and answers
    with EMoR weights, which become a strictly monotone response. A network with learned pooling answers once for all
    windows. For one without, such as that of the CRF-net paper, the windows that agree are averaged.

    Parameters
    ----------
    photos : Photo or iterable of Photo
        Photographs of one camera with the same settings; an iterator needs the memory of one photograph only.
    network : ResponseNetwork
        See `ResponseNetwork.load`.
    windows : int
        Windows of each photograph.
    seed : int
        Seed of the choice of windows.
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
    sources = [_choose_windows(photo, windows, seed, coverage) for photo in photos]
    if not sources:
        raise PhotoError("there is no photograph to analyse; give at least one")
    samples = np.concatenate([source.samples for source in sources])  # (N, 227, 227, 3)
    inputs = network.inputs(samples, progress=progress)  # statistics (N, LENGTH), or the samples
    predictions = network.predict(inputs, progress=progress)
    kept = pooling.inliers(predictions.weights)
    answer = predictions.pooled or pooling.robust_mean(predictions, kept)
    curve = ResponseCurve.from_samples(EmorBasis.load().reconstruct(answer.weights))
    spread = pooling.spread(predictions.weights[kept])
    uncertainty = network.config.uncertainty_model.uncertainty(answer.expected_error, spread)
    return ResponseEstimate(
        curve=curve,
        weights=answer.weights,
        windows=_window_estimates(sources, predictions, kept),
        spread=spread,
        uncertainty=uncertainty,
        band=network.config.uncertainty_model.band(curve, uncertainty),
        warnings=_warnings(sources, samples),
        model=network.config.label,
        photos=tuple(source.name for source in sources),
    )


@dataclass(frozen=True)
class _Source:
    """What stays of a photograph once its windows are cut: name, whether it is gray, windows and their samples."""

    name: str
    is_gray: bool
    windows: tuple[Window, ...]
    samples: Float32Array


def _choose_windows(photo: Photo, count: int, seed: int, coverage: int) -> _Source:
    """Return the windows of one photograph; an error names its file."""
    try:
        windows = select_windows(photo.pixels, count=count, seed=seed, coverage=coverage)
    except PhotoError as problem:
        raise PhotoError(f"{photo.path}: {problem}") from None
    return _Source(photo.path.name, photo.is_gray, windows, cut_windows(photo.pixels, windows))


def _window_estimates(
    sources: Sequence[_Source], predictions: Predictions, kept: BoolArray
) -> tuple[WindowEstimate, ...]:
    """Return what the network says of each window, in the order of the photographs."""
    origins = [(number, window) for number, source in enumerate(sources) for window in source.windows]
    answers = zip(predictions.weights, predictions.expected_errors.tolist(), kept.tolist(), strict=True)
    return tuple(WindowEstimate(*origin, *answer) for origin, answer in zip(origins, answers, strict=True))


def _warnings(sources: Sequence[_Source], samples: Float32Array) -> tuple[str, ...]:
    """Return what makes a poor estimate likely, in words."""
    warnings = []
    if not any(window.covers_range for source in sources for window in source.windows):
        warnings.append("no window covers the range of brightness: expect a poor estimate")
    if all(source.is_gray for source in sources):
        warnings.append("gray photograph: one channel says less than three, and it may be a mixture of channels")
    if np.mean((samples <= 0.5 / 255) | (samples >= 254.5 / 255)) > MOSTLY_CLIPPED:
        warnings.append("mostly clipped: take a photograph with another exposure")
    return tuple(warnings)
