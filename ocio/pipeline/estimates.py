"""From photographs, frames or movies to the response that is estimated from them, and its LUT."""

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Self

from crfnet_core.errors import check_kinds
from crfnet_core.estimate.analysis import CutPhotograph, cut_photograph
from crfnet_core.estimate.estimate import estimate_response
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.estimate.result import CameraAnswer, ResponseEstimate
from crfnet_core.library import camera_estimate, find_camera, offered_cameras, with_camera
from crfnet_core.network import ResponseNetwork
from crfnet_core.photograph.metadata.color_tags import ColorTags
from crfnet_core.photograph.photo import Photo
from crfnet_core.posterior import Prior
from crfnet_core.types import Float32Array, Progress

from ..errors import PlateError
from ..luts.lut1d import Lut1D, inverse_response_lut
from ..movies.library import is_movie
from ..movies.source import PlateSource, file_source, movie_of, photographs_of
from ..options import EstimateOptions
from ..plates.frame_pattern import FramePattern
from ..plates.frames import find_frames, sample_frames
from ..report.facts import PhotoEntry, provenance
from .photographs import is_folder, named_paths, unique

#: Longer side in pixels of the photograph as the sheet shows it.
PREVIEW_SIDE = 960


@dataclass(frozen=True, eq=False)
class PhotographFacts:
    """The facts about an analyzed photograph that its files need once its pixels are gone."""

    entry: PhotoEntry  # of the document
    tags: ColorTags  # its primaries, as the file names them
    plate: PlateSource  # the file, or the frame of a movie
    preview: Float32Array  # every `stride`-th pixel, (h, w, 3), in [0, 1]; empty except of the first photograph
    stride: int

    @classmethod
    def from_photo(cls, photo: Photo, plate: PlateSource, *, has_preview: bool) -> Self:
        """Return the facts about a photograph of a plate."""
        (height, width), metadata = photo.shape[:2], photo.metadata
        stride, has_gain_map = max(1, -(-max(height, width) // PREVIEW_SIDE)), bool(metadata and metadata.has_gain_map)
        return cls(
            entry=PhotoEntry(photo.path.name, width, height, photo.bit_depth, has_gain_map),
            tags=metadata.color if metadata else ColorTags(),
            plate=plate,
            preview=photo[::stride, ::stride].copy() if has_preview else photo[:0, :0].copy(),
            stride=stride,
        )


@dataclass(frozen=True, eq=False)
class FileEstimate:
    """The response that photographs have in common, and the facts about them."""

    estimate: ResponseEstimate
    photographs: tuple[PhotographFacts, ...]  # of all sources; of a sequence or movie the frames that were analyzed
    firsts: tuple[PhotographFacts, ...]  # the first of each source, which becomes its linear plate
    offers: tuple[CameraAnswer, ...]  # stored cameras of the first photograph's model, if none was asked for
    movies: tuple[str, ...]  # the report's line of each movie


def photograph_sources(names: Sequence[Path], frames: str | None = None) -> list[PlateSource]:
    """Return the sources to estimate one response from: of a sequence some frames, spread over it.

    `names` are photographs, movies, and sequences as `find_frames` knows them; `frames` chooses frames of the latter
    two, as in `parse_frames`. Raise PlateError if there are none, or a name leads to a folder or to nothing.
    """
    patterns: dict[Path, str] = {}
    for name in named_paths(names):
        is_single = frames is None and (name.is_file() or FramePattern.parse(name) is None)
        if is_single and is_folder(name):  # before the output is looked at
            raise PlateError("folder_for_photograph", path=name, pattern=name / "shot.%04d.png")
        if is_single and not os.path.lexists(name):
            raise PlateError("no_such_file", path=name)
        if is_single or is_movie(name):
            patterns[name] = ""
        else:
            sequence = find_frames(name, frames)
            patterns |= dict.fromkeys(sample_frames(sequence), sequence.pattern)
    return [file_source(path, frames, pattern=patterns[path]) for path in unique(patterns)]


def estimate_files(
    sources: Sequence[PlateSource], options: EstimateOptions, *, progress: Progress | None = None
) -> FileEstimate:
    """Estimate the response that photographs, sequences and movies have in common.

    Of a sequence or movie, up to `FRAMES_ANALYZED` frames are analyzed, spread over it. Only one photograph is in
    memory at a time: for its linear plate the file is read again.

    Parameters
    ----------
    sources : sequence of PlateSource
        At least one; all of one camera with the same settings.
    options : EstimateOptions
        The network, the prior, and the choices of the analysis.
    progress : callable or None
        Called with (done, total) after every window.

    Raises
    ------
    CRFNetError
        If the network, the prior or the camera cannot be loaded, a photograph cannot be read or is smaller than a
        window, or a file has a published curve.
    """
    sources = tuple(sources) if isinstance(sources, Iterable) else (sources,)
    check_kinds(options=(options, EstimateOptions))
    for source in sources:
        check_kinds(sources=(source, PlateSource))
    camera = find_camera(options.camera) if options.camera is not None else None  # first, so as to refuse a wrong name
    prior, network = Prior.load(options.prior), load_network(options.model, options.threads)
    analyzed = list(_cut_photographs(sources, options.analysis))
    cut, photographs, positions = zip(*analyzed, strict=True) if analyzed else ((), (), ())
    estimate = estimate_response(cut, network=network, prior=prior, progress=progress)
    is_offering = options.analysis.use_metadata and camera is None
    return FileEstimate(
        estimate=with_camera(estimate, camera) if camera else estimate,
        photographs=photographs,
        firsts=tuple(facts for facts, position in zip(photographs, positions, strict=True) if position == 0),
        offers=offered_cameras(estimate) if is_offering else (),
        movies=tuple(str(movie) for movie in map(movie_of, sources) if movie),
    )


def _cut_photographs(
    sources: Sequence[PlateSource], options: AnalysisOptions
) -> Iterator[tuple[CutPhotograph, PhotographFacts, int]]:
    """Yield the windows, the facts and the place in its source of each photograph; one is in memory at a time."""
    for number, source in enumerate(sources):
        for position, (plate, photo) in enumerate(photographs_of(source)):
            facts = PhotographFacts.from_photo(photo, plate, has_preview=position == number == 0)
            yield cut_photograph(photo, options), facts, position


def response_lut(estimate: ResponseEstimate) -> Lut1D:
    """Return the inverse of an estimated response as a LUT with its provenance."""
    return inverse_response_lut(estimate.curve, comments=provenance(estimate))


@lru_cache(maxsize=1)
def load_network(model: Path | None, threads: int) -> ResponseNetwork:
    """Return a network, as in `EstimateOptions`; the last one stays loaded."""
    return ResponseNetwork.load(model, threads=threads)


def load_camera_response(options: EstimateOptions) -> ResponseEstimate | None:
    """Return the response of the stored camera that the options name, for photographs that nobody looks at, or None."""
    return camera_estimate(find_camera(options.camera)) if options.camera is not None else None
