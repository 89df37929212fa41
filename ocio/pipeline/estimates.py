"""From photographs or frames to the response that is estimated from them, and its LUT."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from crfnet_core.estimate.estimate import estimate_response
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.estimate.result import CameraAnswer, ResponseEstimate
from crfnet_core.library import CameraSettings, offered_cameras, with_camera
from crfnet_core.network import ResponseNetwork
from crfnet_core.photograph.metadata import Device
from crfnet_core.photograph.metadata.color_tags import ColorTags
from crfnet_core.photograph.photo import Photo
from crfnet_core.posterior import Prior
from crfnet_core.types import Float32Array, Progress

from ..defaults import LUT_LENGTH
from ..errors import PlateError
from ..luts.lut1d import Lut1D, inverse_response_lut
from ..movies.library import is_movie
from ..movies.source import PlateSource, file_source, movie_of, photographs_of
from ..options import EstimateOptions
from ..plates.frame_pattern import FramePattern
from ..plates.frames import find_frames, sample_frames
from ..report import PhotoFacts, provenance
from .loading import load_camera
from .photographs import each_once, is_folder

#: Longer side in pixels of the photograph as the sheet shows it.
PREVIEW_SIDE = 960


@dataclass(frozen=True, eq=False)
class PhotographEstimate:
    """An estimate, and what its files still need of the photographs once their pixels are gone.

    Parameters
    ----------
    paths : tuple of Path
        The photographs, and movies.
    facts : tuple of PhotoFacts
        What the report says of each photograph, and of each frame of a movie that was analysed.
    tags : tuple of ColorTags
        What each file says of its primaries.
    preview : ndarray, float32, shape (h, w, 3)
        Every `stride`-th pixel of the first photograph, code values in [0, 1].
    stride : int
        Distance between the pixels of `preview` in the photograph.
    estimate : ResponseEstimate
        The response that they have in common.
    plates : tuple of PlateSource
        For each of `paths`, what becomes its linear plate: the photograph, or the first frame of the movie analysed.
    alphas : tuple of str
        How the colours of each of `plates` are stored beside alpha: see `FileMetadata.alpha`.
    offers : tuple of CameraAnswer
        Stored cameras of the first photograph's make and model, if none was asked for.
    """

    paths: tuple[Path, ...]
    facts: tuple[PhotoFacts, ...]
    tags: tuple[ColorTags, ...]
    preview: Float32Array
    stride: int
    estimate: ResponseEstimate
    plates: tuple[PlateSource, ...]
    alphas: tuple[str, ...]
    offers: tuple[CameraAnswer, ...] = ()

    @property
    def movies(self) -> tuple[str, ...]:
        """What the report says of each movie, one line each."""
        return tuple(str(movie) for plate in self.plates if (movie := movie_of(plate)))


def sampled_photographs(names: Sequence[Path], frames: str | None = None) -> list[Path]:
    """Return the files to estimate one response from: of a sequence some frames, spread over it, and all else as it is.

    A file that is given twice counts once.

    Parameters
    ----------
    names : sequence of Path
        Photographs, movies, and sequences of frames as `find_frames` knows them.
    frames : str or None
        The frames of a sequence to choose from, as in `parse_frames`; all by default. Those of a movie are chosen in
        `estimate_photographs`.

    Raises
    ------
    PlateError
        If a sequence has no such frames, `frames` is malformed or given for a single photograph, or a name is that of a
        folder, or of nothing.
    """
    found: list[Path] = []
    for name in names:
        is_single = frames is None and (name.is_file() or FramePattern.parse(name) is None)
        if is_single:
            _check_file(name)
        found += [name] if is_single or is_movie(name) else sample_frames(find_frames(name, frames))
    return each_once(found)


def _check_file(name: Path) -> None:
    """Refuse a folder, and the name of nothing, before the output is looked at."""
    if is_folder(name):
        shot = name / "shot.%04d.png"
        raise PlateError(
            f"{name}: is a folder; give one photograph, the frames of a shot ({shot}), or --each for every photograph"
            " in it"
        )
    if not os.path.lexists(name):
        raise PlateError(f"{name}: there is no such file; check the name")


def estimate_photographs(
    paths: Sequence[Path],
    network: ResponseNetwork,
    prior: Prior,
    options: EstimateOptions,
    *,
    frames: str | None = None,
    progress: Progress | None = None,
) -> PhotographEstimate:
    """Read photographs one by one and estimate the response that they have in common.

    Only one photograph is in memory at a time; a preview of the first remains. `write_estimate` therefore reads each
    photograph a second time for its linear plate: the pixels of many photographs do not fit into memory, and all
    estimates have to succeed before anything is written.

    Parameters
    ----------
    paths : sequence of Path
        Photographs of one camera with the same settings; at least one. Of a movie, some frames are taken: see
        `crfnet.movies.selection.chosen_photos`.
    network : ResponseNetwork
        See `load_network`.
    prior : Prior
        See `load_prior`.
    options : EstimateOptions
        Windows, seed, and whether metadata counts.
    frames : str or None
        The frames of a movie to choose from, as in `crfnet.plates.frame_numbers.parse_frames`; all by default.
    progress : callable or None
        Called with (done, total) after every window.

    Raises
    ------
    PhotoError
        If a photograph cannot be read or is smaller than a window, or a movie has a published curve.
    PlateError
        If a movie cannot be read.
    """
    kept = _Kept()
    estimate = _estimate(kept.reading(paths, frames), network, prior, options, progress)
    is_offering = options.use_metadata and options.camera is None
    return PhotographEstimate(
        paths=tuple(paths),
        facts=tuple(kept.facts),
        tags=tuple(kept.tags),
        preview=kept.previews[0],
        stride=_stride(kept.facts[0]),
        estimate=estimate,
        plates=tuple(kept.plates),
        alphas=tuple(kept.alphas),
        offers=tuple(offered_cameras(estimate, kept.settings[0], prior=prior)) if is_offering else (),
    )


@dataclass
class _Kept:
    """What is kept of photographs while they are read one by one.

    Parameters
    ----------
    facts, settings : list
        Of each photograph, and of each frame of a movie.
    previews : list of ndarray
        That of the first photograph.
    tags, plates, alphas : list
        Of each file.
    """

    facts: list[PhotoFacts] = field(default_factory=list)
    settings: list[CameraSettings] = field(default_factory=list)
    previews: list[Float32Array] = field(default_factory=list)
    tags: list[ColorTags] = field(default_factory=list)
    plates: list[PlateSource] = field(default_factory=list)
    alphas: list[str] = field(default_factory=list)

    def reading(self, paths: Sequence[Path], frames: str | None) -> Iterator[Photo]:
        """Yield the photographs, and the chosen frames of movies; one is in memory at a time."""
        for path in paths:
            for index, (plate, photo) in enumerate(photographs_of(file_source(path, frames))):
                self.facts.append(PhotoFacts.of(photo))
                self.settings.append(CameraSettings.of(photo.metadata))
                if not self.previews:
                    stride = _stride(self.facts[0])
                    self.previews.append(photo[::stride, ::stride].copy())
                if index == 0:
                    self.tags.append(photo.metadata.color if photo.metadata else ColorTags())
                    self.plates.append(plate)
                    self.alphas.append(photo.metadata.alpha if photo.metadata else "")
                yield photo


def estimate_frames(
    sequence: PlateSource,
    network: ResponseNetwork,
    prior: Prior,
    options: EstimateOptions,
    *,
    progress: Progress | None = None,
) -> ResponseEstimate:
    """Estimate the one response of a sequence or movie from up to `FRAMES_ANALYZED` of its frames, spread over it.

    Only one frame is in memory at a time, so these few frames are read again when the sequence is linearised.

    Parameters
    ----------
    sequence : PlateSource
        The frames, or a single file, as `crfnet.movies.source.find_source` returns them.
    network : ResponseNetwork
        See `load_network`.
    prior : Prior
        See `load_prior`.
    options : EstimateOptions
        Windows of each frame, seed, and whether metadata counts.
    progress : callable or None
        Called with (done, total) after every window.

    Raises
    ------
    PhotoError
        If a frame cannot be read or is smaller than a window, or a movie has a published curve.
    """
    return _estimate((photo for _, photo in photographs_of(sequence)), network, prior, options, progress)


def response_lut(estimate: ResponseEstimate, *, length: int = LUT_LENGTH) -> Lut1D:
    """Return the inverse of an estimated response as a LUT with its provenance.

    Raises
    ------
    LutError
        If the length is not 2 to 65536.
    """
    return inverse_response_lut(estimate.curve, length=length, comments=provenance(estimate))


def _estimate(
    photos: Iterable[Photo],
    network: ResponseNetwork,
    prior: Prior,
    options: EstimateOptions,
    progress: Progress | None,
) -> ResponseEstimate:
    """Return the response that photographs have in common, or that of a stored camera, by the options."""
    camera = load_camera(options)  # first, so that a wrong name is refused at once
    estimate = estimate_response(
        photos,
        network=network,
        prior=prior,
        options=AnalysisOptions(
            use_metadata=options.use_metadata,
            device=_device(options.device),
            windows=options.windows,
            seed=options.seed,
        ),
        progress=progress,
    )
    return with_camera(estimate, camera, prior=prior) if camera else estimate


def _device(told: str | None) -> Device | None:
    """Return what a person says took photographs."""
    return None if told is None else Device.UNKNOWN if told == "other" else Device(told)


def _stride(facts: PhotoFacts) -> int:
    """Return how many pixels apart the samples of a photograph's preview lie."""
    return max(1, -(-max(facts.width, facts.height) // PREVIEW_SIDE))
