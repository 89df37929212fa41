"""The method: from one photograph, or several of one camera, to its response and how far to trust it.

`estimate_response` is the whole of it on one screen; docs/METHOD.md explains each step with its equations.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from crfnet_core.errors import PhotoError
from crfnet_core.metadata import FileOrigin, family_factors, file_origin
from crfnet_core.network import ResponseNetwork, pooling
from crfnet_core.photo import Photo
from crfnet_core.posterior import (
    Evidence,
    Family,
    Posterior,
    Prior,
    ResponseBank,
    Verdict,
    independent_share,
    scene_similarities,
)
from crfnet_core.recognition import Levels, Recognition, log_factor, recognize, refuse_tagged
from crfnet_core.response_estimate import ResponseEstimate, WindowEstimate
from crfnet_core.types import Float32Array, Float64Array, Pixels, Progress
from crfnet_core.windows import FULL_COVERAGE, WINDOWS_PER_PHOTOGRAPH, Window, cut_windows, select_windows

__all__ = ["ResponseEstimate", "WindowEstimate", "estimate_response"]

#: Fraction of samples at the ends of the range above which a photograph counts as mostly clipped.
MOSTLY_CLIPPED = 0.5

#: Samples along each side of the thumbnails by which photographs of one scene are recognised.
THUMBNAIL = 16


def estimate_response(
    photos: Photo | Iterable[Photo],
    *,
    network: ResponseNetwork,
    prior: Prior | None = None,
    bank: ResponseBank | None = None,
    use_metadata: bool = True,
    windows: int = WINDOWS_PER_PHOTOGRAPH,
    seed: int = 0,
    coverage: int = FULL_COVERAGE,
    progress: Progress | None = None,
) -> ResponseEstimate:
    """Estimate the response of the camera that took one or several photographs.

    Windows are cut from every photograph. The network reads them, or statistics that are counted in them, and states
    evidence: which responses make such a photograph likely. Prior times the evidence of all photographs is the
    posterior over a bank of responses, and the answer is the response of least expected error in it.

    Parameters
    ----------
    photos : Photo or iterable of Photo
        Photographs of one camera with the same settings; an iterator needs the memory of one photograph only.
    network : ResponseNetwork
        See `ResponseNetwork.load`.
    prior : Prior, optional
        How likely each family of responses is beforehand; by default the packaged prior "camera".
    bank : ResponseBank, optional
        The responses to choose from; by default the packaged ones.
    use_metadata : bool
        Whether what the files say of their making counts: see `crfnet_core.metadata`.
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
        If there is no photograph, one is smaller than a window, something else is given, or a file names an encoding
        with a published curve.
    """
    sources = [_choose_windows(photo, windows, seed, coverage, use_metadata) for photo in _checked(photos)]
    if not sources:
        raise PhotoError("there is no photograph to analyse; give at least one")
    bank = bank or ResponseBank.load()
    origins = tuple(source.origin for source in sources if source.origin is not None and use_metadata)
    levels = Levels.joint([source.levels for source in sources])
    prior = (prior or Prior.load()).given(_metadata_factors(origins)).given({Family.LOG: log_factor(levels)})
    readings = _readings(sources, network, progress)
    independent = independent_share(scene_similarities([source.thumbnail for source in sources]))
    evidences = [reading.evidence for reading in readings]
    posterior = Posterior.of(bank, prior, evidences, independent=independent)
    makes = tuple(source.make for source in sources if use_metadata)
    recognition = recognize(levels, log_probability=posterior.families[Family.LOG], makes=makes)
    return ResponseEstimate(
        curve=posterior.curve,
        weights=posterior.mean_weights,
        windows=_window_estimates(sources, readings, bank, prior),
        uncertainty=posterior.expected_error,
        shape_uncertainty=posterior.expected_shape_error,
        band=posterior.band(),
        families=posterior.families,
        verdict=Verdict.DO_NOT_TRUST if recognition else Verdict.of(posterior),
        prior=prior.name,
        origins=origins,
        warnings=_warnings(sources, origins, recognition),
        model=network.config.label,
        photos=tuple(source.name for source in sources),
        recognition=recognition,
    )


@dataclass(frozen=True)
class _Source:
    """What stays of a photograph once its windows are cut."""

    name: str
    is_gray: bool
    windows: tuple[Window, ...]
    samples: Float32Array
    thumbnail: Float64Array
    levels: Levels
    make: str
    origin: FileOrigin | None


@dataclass(frozen=True)
class _Reading:
    """The evidence of a photograph, and of each of its windows by itself."""

    evidence: Evidence
    windows: tuple[Evidence, ...]


def _checked(photos: Photo | Iterable[Photo]) -> Iterator[Photo]:
    """Yield the photographs, one by one; refuse what is none, such as a file's name or an array."""
    several: Iterable[object] = (photos,)
    if isinstance(photos, Iterable) and not isinstance(photos, str | np.ndarray):
        several = photos
    for photo in several:
        if not isinstance(photo, Photo):
            raise PhotoError(
                f"a {type(photo).__name__} is no Photo; read_photo makes one of a file, Photo.from_array of an array"
            )
        yield photo


def _choose_windows(photo: Photo, count: int, seed: int, coverage: int, use_metadata: bool) -> _Source:
    """Return the windows of one photograph; an error names its file."""
    metadata = photo.metadata
    if use_metadata:
        refuse_tagged(photo)
    try:
        windows = select_windows(photo, count=count, seed=seed, coverage=coverage)
    except PhotoError as problem:
        raise PhotoError(f"{photo.path}: {problem}") from None
    samples = cut_windows(photo, windows)
    return _Source(
        name=photo.path.name,
        is_gray=photo.is_gray,
        windows=windows,
        samples=samples,
        thumbnail=_thumbnail(photo),
        levels=Levels.of(photo),
        make="" if metadata is None else metadata.make,
        origin=None if metadata is None else file_origin(metadata),
    )


def _metadata_factors(origins: Sequence[FileOrigin]) -> dict[Family, float]:
    """Return factors on the families: the geometric mean over photographs, since one camera took them all."""
    if not origins:
        return {}
    factors = [family_factors(origin) for origin in origins]
    return {family: float(np.exp(np.mean([np.log(each[family]) for each in factors]))) for family in Family}


def _thumbnail(pixels: Pixels) -> Float64Array:
    """Return ranks of brightness on a coarse grid, shape (16, 16): no exposure or response changes them."""
    rows, columns = (np.linspace(0, side - 1, 4 * THUMBNAIL).round().astype(int) for side in pixels.shape[:2])
    samples = pixels[np.ix_(rows, columns)].mean(axis=2)  # (64, 64)
    cells = samples.reshape(THUMBNAIL, 4, THUMBNAIL, 4).mean(axis=(1, 3))
    ranks: Float64Array = cells.ravel().argsort().argsort().reshape(cells.shape).astype(np.float64)
    return ranks


def _readings(sources: Sequence[_Source], network: ResponseNetwork, progress: Progress | None) -> list[_Reading]:
    """Return what the network reads in each photograph."""
    readings: list[_Reading] = []
    total, done = sum(len(source.windows) for source in sources), 0
    for source in sources:

        def moved(count: int, _: int, before: int = done) -> None:
            if progress is not None:
                progress(before + count, total)

        predictions = network.predict(network.inputs(source.samples, progress=moved), progress=moved)
        evidence = predictions.pooled or pooling.robust_mean(predictions.windows)
        readings.append(_Reading(evidence, predictions.windows))
        done += len(source.windows)
    return readings


def _window_estimates(
    sources: Sequence[_Source], readings: Sequence[_Reading], bank: ResponseBank, prior: Prior
) -> tuple[WindowEstimate, ...]:
    """Return what each window says by itself, in the order of the photographs."""
    origins = [(number, window) for number, source in enumerate(sources) for window in source.windows]
    posteriors = [Posterior.of(bank, prior, [evidence]) for reading in readings for evidence in reading.windows]
    weights = np.stack([posterior.mean_weights for posterior in posteriors])
    answers = zip(weights, (posterior.expected_distance for posterior in posteriors), strict=True)
    kept = pooling.inliers(weights).tolist()
    return tuple(
        WindowEstimate(*origin, *answer, kept=is_kept)
        for origin, answer, is_kept in zip(origins, answers, kept, strict=True)
    )


def _warnings(
    sources: Sequence[_Source], origins: Sequence[FileOrigin], recognition: Recognition | None
) -> tuple[str, ...]:
    """Return what makes a poor estimate likely, in words."""
    editors = dict.fromkeys(origin.editor for origin in origins if origin.editor)
    warnings = [recognition.reason] if recognition else []
    warnings += [
        f"saved by {editor}, which may have changed the tones: give the camera's own file" for editor in editors
    ]
    if not any(window.covers_range for source in sources for window in source.windows):
        warnings.append("no window covers the range of brightness: expect a poor estimate")
    if all(source.is_gray for source in sources):
        warnings.append("gray photograph: one channel says less than three, and it may be a mixture of channels")
    clipped = [(source.samples <= 0.5 / 255) | (source.samples >= 254.5 / 255) for source in sources]
    if np.mean([part.mean() for part in clipped]) > MOSTLY_CLIPPED:
        warnings.append("mostly clipped: take a photograph with another exposure")
    return tuple(warnings)
