"""From a photograph to its windows, and from the windows to evidence: all that an estimate needs of the pixels."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from crfnet_core.errors import PhotoError
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.network import ResponseNetwork
from crfnet_core.photograph.metadata import Device, FileMetadata, FileOrigin, file_origin, with_stated_device
from crfnet_core.photograph.photo import Photo
from crfnet_core.photograph.recognition import Levels, refuse_tagged
from crfnet_core.posterior import Evidence
from crfnet_core.statistics.windows import Window, cut_windows, select_windows
from crfnet_core.types import Float32Array, Float64Array, Pixels, Progress, counted_from

#: Samples along each side of the thumbnails that recognize photographs of one scene.
THUMBNAIL = 16

#: Correlation of neighboring cells of a thumbnail below which there is no scene: 92 real photographs have at least
#: 0.53, renderings of 20 scenes 0.37, and noise, also blurred over a fortieth of the frame, at most 0.22.
LEAST_CORRELATION = 0.25

#: Samples below or above these are clipped: half an 8-bit code from either end of the range.
DARKEST, BRIGHTEST = 0.5 / 255, 254.5 / 255


@dataclass(frozen=True, eq=False)
class CutPhotograph:
    """The windows of a photograph, and the facts about it that an estimate needs."""

    name: str
    windows: tuple[Window, ...]  # at least one
    samples: Float32Array  # (N, side, side, 3): pixels of the windows
    thumbnail: Float64Array  # (16, 16): ranks of brightness, which no exposure or response changes
    levels: Levels  # its darkest, its middle and its brightest samples
    make: str  # the camera's maker, as the file writes it; empty if metadata is ignored
    origin: FileOrigin | None  # how the file was made, by its metadata and the user; None if neither says anything
    is_gray: bool  # whether its three channels are equal
    clipped: float  # fraction of the samples of its windows at the ends of the range

    @property
    def is_noise(self) -> bool:
        """Whether neighboring cells of the thumbnail are no more alike than any two: then it shows no scene."""
        cells = self.thumbnail - self.thumbnail.mean()
        products = (cells[1:] * cells[:-1]).mean() + (cells[:, 1:] * cells[:, :-1]).mean()
        return bool(products / 2 < LEAST_CORRELATION * (cells**2).mean())


@dataclass(frozen=True, eq=False)
class AnalyzedPhotograph:
    """A photograph and its evidence."""

    photograph: CutPhotograph
    evidence: Evidence  # how likely each response makes the photograph
    window_evidences: tuple[Evidence, ...]  # the same for each of its windows alone


#: One photograph or several; those that are cut already need no memory for their pixels.
Photographs = Photo | CutPhotograph | Iterable[Photo | CutPhotograph]


def cut_photograph(photo: Photo, options: AnalysisOptions | None = None) -> CutPhotograph:
    """Return the windows of a photograph.

    Raise PhotoError if it is smaller than a window, its file names an encoding with a published curve, or
    `options.device` is not a `Device`.
    """
    options = options or AnalysisOptions()
    metadata = photo.metadata if options.use_metadata else None
    if options.use_metadata:
        refuse_tagged(photo)
    windows = _selected_windows(photo, options)
    samples = cut_windows(photo, windows)
    return CutPhotograph(
        name=photo.path.name,
        windows=windows,
        samples=samples,
        thumbnail=_thumbnail(photo),
        levels=Levels.from_pixels(photo),
        make="" if metadata is None else metadata.make,
        origin=_origin(metadata, options.device),
        is_gray=photo.is_gray,
        clipped=float(((samples <= DARKEST) | (samples >= BRIGHTEST)).mean()),
    )


def analyze_photographs(
    photos: Photographs,
    *,
    network: ResponseNetwork,
    options: AnalysisOptions | None = None,
    progress: Progress | None = None,
) -> tuple[AnalyzedPhotograph, ...]:
    """Return the evidence of each photograph; `estimate_response` explains the parameters and the errors."""
    cut = [photo if isinstance(photo, CutPhotograph) else cut_photograph(photo, options) for photo in _each(photos)]
    if not cut:
        raise PhotoError("no_photographs")
    total, done = sum(len(photograph.samples) for photograph in cut), 0
    analyzed = []
    for photograph in cut:
        predictions = network.predict(photograph.samples, progress=counted_from(progress, done, total))
        analyzed.append(AnalyzedPhotograph(photograph, predictions.pooled, predictions.windows))
        done += len(photograph.samples)
    return tuple(analyzed)


def _each(photos: Photographs) -> Iterator[Photo | CutPhotograph]:
    """Yield the photographs one by one; refuse everything else, such as a file's name or an array."""
    several: Iterable[object] = (photos,)
    if isinstance(photos, Iterable) and not isinstance(photos, str | np.ndarray):
        several = photos
    for photo in several:
        if not isinstance(photo, Photo | CutPhotograph):
            raise PhotoError("not_a_photo", kind=type(photo).__name__)
        yield photo


def _selected_windows(photo: Photo, options: AnalysisOptions) -> tuple[Window, ...]:
    """Return where the windows of a photograph lie; an error names its file."""
    try:
        return select_windows(photo, count=options.windows, seed=options.seed, coverage=options.coverage)
    except PhotoError as problem:
        raise PhotoError("in_file", path=photo.path, problem=problem) from None


def _origin(metadata: FileMetadata | None, device: Device | None) -> FileOrigin | None:
    """Return how a photograph was made; None if nothing is known."""
    if device is None:
        return None if metadata is None else file_origin(metadata)
    try:
        return with_stated_device(file_origin(metadata or FileMetadata()), device)
    except ValueError:
        names = ", ".join(kind.name for kind in Device)
        raise PhotoError("not_a_device", device=repr(device), names=names) from None


def _thumbnail(pixels: Pixels) -> Float64Array:
    """Return ranks of brightness on a coarse grid, shape (16, 16)."""
    rows, columns = (np.linspace(0, side - 1, 4 * THUMBNAIL).round().astype(int) for side in pixels.shape[:2])
    samples = pixels[np.ix_(rows, columns)].mean(axis=2)  # (64, 64)
    cells = samples.reshape(THUMBNAIL, 4, THUMBNAIL, 4).mean(axis=(1, 3))
    ranks: Float64Array = cells.ravel().argsort(kind="stable").argsort().reshape(cells.shape).astype(np.float64)
    return ranks
