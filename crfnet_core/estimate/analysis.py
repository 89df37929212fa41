"""From a photograph to its windows, and from the windows to evidence: all that an estimate needs of the pixels."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from crfnet_core.errors import PhotoError, check_kinds
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.network import Predictions, ResponseNetwork
from crfnet_core.photograph.metadata import FileMetadata, FileOrigin, file_origin, with_stated_device
from crfnet_core.photograph.photo import Photo
from crfnet_core.photograph.recognition import Levels, is_monochrome, refuse_tagged
from crfnet_core.photograph.thumbnail import thumbnail
from crfnet_core.statistics.windows import WINDOW_SIZE, Window, cut_windows, select_windows
from crfnet_core.types import Float32Array, Float64Array, Progress, counted_from

#: Samples below or above these are clipped: half an 8-bit code from either end of the range.
DARKEST, BRIGHTEST = 0.5 / 255, 254.5 / 255


@dataclass(frozen=True, eq=False)
class CutPhotograph:
    """The windows of a photograph, and the facts about it that an estimate needs."""

    name: str
    windows: tuple[Window, ...]  # at least one
    samples: Float32Array  # (N, side, side, 3): pixels of the windows
    thumbnail: Float64Array  # (16, 16): see `crfnet_core.photograph.thumbnail`
    levels: Levels  # its darkest, its middle and its brightest samples
    make: str  # the camera's maker, as the file writes it; empty if metadata is ignored
    origin: FileOrigin | None  # how the file was made, by its metadata and the user; None if neither says anything
    is_gray: bool  # whether its colors are functions of its brightness: gray, or toned
    clipped: float  # fraction of the samples of its windows at the ends of the range


#: One photograph or several; those that are cut already need no memory for their pixels.
Photographs = Photo | CutPhotograph | Iterable[Photo | CutPhotograph]


def cut_photograph(photo: Photo, options: AnalysisOptions | None = None) -> CutPhotograph:
    """Return the windows of a photograph.

    Raise PhotoError if it is not a `Photo`, is smaller than a window, or its file names a published encoding.
    """
    if not isinstance(photo, Photo):
        raise PhotoError("not_a_photo", kind=type(photo).__name__)
    check_kinds(options=(options, AnalysisOptions | None))
    options = options or AnalysisOptions()
    photo = photo if options.use_metadata else photo.with_metadata(None)
    refuse_tagged(photo)
    height, width = photo.shape[:2]
    if min(height, width) < WINDOW_SIZE:
        raise PhotoError("smaller_than_window", path=photo.path, width=width, height=height, least=WINDOW_SIZE)
    windows = select_windows(photo, count=options.windows, seed=options.seed, coverage=options.coverage)
    samples = cut_windows(photo, windows)
    origin = None if photo.metadata is None else file_origin(photo.metadata)
    if options.device is not None:
        origin = with_stated_device(origin or file_origin(FileMetadata()), options.device)
    return CutPhotograph(
        name=photo.path.name,
        windows=windows,
        samples=samples,
        thumbnail=thumbnail(photo),
        levels=Levels.from_pixels(photo),
        make=photo.metadata.make if photo.metadata else "",
        origin=origin,
        is_gray=photo.is_gray or is_monochrome(samples),
        clipped=float(((samples <= DARKEST) | (samples >= BRIGHTEST)).mean()),
    )


def cut_photographs(photos: Photographs, options: AnalysisOptions | None = None) -> tuple[CutPhotograph, ...]:
    """Return the windows of one or several photographs; raise PhotoError for anything else, such as a file's name."""
    several: Iterable[Any] = photos if isinstance(photos, Iterable) else (photos,)
    photographs = tuple(each if isinstance(each, CutPhotograph) else cut_photograph(each, options) for each in several)
    if not photographs:
        raise PhotoError("no_photographs")
    return photographs


def predict_evidence(
    photographs: Sequence[CutPhotograph], network: ResponseNetwork, *, progress: Progress | None = None
) -> tuple[Predictions, ...]:
    """Return the evidence in each photograph; `progress` counts the windows of all."""
    total, done = sum(len(photograph.samples) for photograph in photographs), 0
    predictions = []
    for photograph in photographs:
        predictions.append(network.predict(photograph.samples, progress=counted_from(progress, done, total)))
        done += len(photograph.samples)
    return tuple(predictions)
