"""What stays of a photograph once the network has read it: its evidence, and what an estimate needs beside it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np

from crfnet_core.errors import PhotoError
from crfnet_core.network import ResponseNetwork
from crfnet_core.photograph.metadata import Device, FileMetadata, FileOrigin, file_origin, with_stated_device
from crfnet_core.photograph.photo import Photo
from crfnet_core.photograph.recognition import Levels, refuse_tagged
from crfnet_core.posterior import Evidence
from crfnet_core.statistics.windows import FULL_COVERAGE, WINDOWS_PER_PHOTOGRAPH, Window, cut_windows, select_windows
from crfnet_core.types import Float32Array, Float64Array, Pixels, Progress, counted_from

#: Samples along each side of the thumbnails by which photographs of one scene are recognised.
THUMBNAIL = 16


@dataclass(frozen=True, eq=False)
class AnalyzedPhotograph:
    """A photograph as the network has read it.

    Parameters
    ----------
    name : str
        The file's.
    evidence : Evidence
        How likely each response makes the photograph.
    thumbnail : ndarray, float64, shape (16, 16)
        Ranks of brightness on a coarse grid: no exposure or response changes them.
    levels : Levels
        Where its darkest, its middle and its brightest samples lie.
    make : str
        The camera's maker, as the file writes it; empty if metadata is ignored.
    origin : FileOrigin, optional
        What the file, and who knows its camera, say of its making; None if neither says anything.
    is_gray : bool
        Whether its three channels are equal.
    clipped : float
        Fraction of the samples of its windows at the ends of the range.
    windows : tuple of Window
        Its windows; those of a photograph that was kept for later are gone.
    window_evidences : tuple of Evidence
        What each window says by itself.
    """

    name: str
    evidence: Evidence
    thumbnail: Float64Array
    levels: Levels
    make: str
    origin: FileOrigin | None
    is_gray: bool
    clipped: float
    windows: tuple[Window, ...] = ()
    window_evidences: tuple[Evidence, ...] = ()


def analyze_photographs(
    photos: Photo | Iterable[Photo],
    *,
    network: ResponseNetwork,
    use_metadata: bool = True,
    device: Device | None = None,
    windows: int = WINDOWS_PER_PHOTOGRAPH,
    seed: int = 0,
    coverage: int = FULL_COVERAGE,
    progress: Progress | None = None,
) -> tuple[AnalyzedPhotograph, ...]:
    """Return what the network reads in each photograph; `estimate_response` explains the parameters and the errors."""
    sources = [_choose_windows(photo, windows, seed, coverage, use_metadata, device) for photo in _checked(photos)]
    if not sources:
        raise PhotoError("there is no photograph to analyse; give at least one")
    total, done = sum(len(source.samples) for source in sources), 0
    analyzed = []
    for source in sources:
        analyzed.append(_analyzed(source, network, counted_from(progress, done, total)))
        done += len(source.samples)
    return tuple(analyzed)


@dataclass(frozen=True)
class _Source:
    """A photograph whose windows are cut; `analyzed` makes the rest of it once the evidence is known."""

    samples: Float32Array
    analyzed: Callable[..., AnalyzedPhotograph]


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


def _choose_windows(
    photo: Photo, count: int, seed: int, coverage: int, use_metadata: bool, device: Device | None
) -> _Source:
    """Return the windows of one photograph; an error names its file."""
    metadata = photo.metadata if use_metadata else None
    if use_metadata:
        refuse_tagged(photo)
    try:
        windows = select_windows(photo, count=count, seed=seed, coverage=coverage)
    except PhotoError as problem:
        raise PhotoError(f"{photo.path}: {problem}") from None
    samples = cut_windows(photo, windows)
    analyzed = partial(
        AnalyzedPhotograph,
        name=photo.path.name,
        thumbnail=_thumbnail(photo),
        levels=Levels.from_pixels(photo),
        make="" if metadata is None else metadata.make,
        origin=_origin(metadata, device),
        is_gray=photo.is_gray,
        clipped=float(((samples <= 0.5 / 255) | (samples >= 254.5 / 255)).mean()),
        windows=windows,
    )
    return _Source(samples, analyzed)


def _origin(metadata: FileMetadata | None, device: Device | None) -> FileOrigin | None:
    """Return what is known of a photograph's making; None if nothing is."""
    if device is None:
        return None if metadata is None else file_origin(metadata)
    try:
        return with_stated_device(file_origin(metadata or FileMetadata()), device)
    except ValueError:
        names = ", ".join(kind.name for kind in Device)
        raise PhotoError(f"{device!r} is no device; give one of Device: {names}") from None


def _thumbnail(pixels: Pixels) -> Float64Array:
    """Return ranks of brightness on a coarse grid, shape (16, 16): no exposure or response changes them."""
    rows, columns = (np.linspace(0, side - 1, 4 * THUMBNAIL).round().astype(int) for side in pixels.shape[:2])
    samples = pixels[np.ix_(rows, columns)].mean(axis=2)  # (64, 64)
    cells = samples.reshape(THUMBNAIL, 4, THUMBNAIL, 4).mean(axis=(1, 3))
    ranks: Float64Array = cells.ravel().argsort(kind="stable").argsort().reshape(cells.shape).astype(np.float64)
    return ranks


def _analyzed(source: _Source, network: ResponseNetwork, progress: Progress | None) -> AnalyzedPhotograph:
    """Return what the network reads in a photograph."""
    predictions = network.predict(source.samples, progress=progress)
    return source.analyzed(evidence=predictions.pooled, window_evidences=predictions.windows)
