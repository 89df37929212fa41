# SPDX-License-Identifier: GPL-3.0-or-later
"""Run a job: estimate the response and write files, through `crfnet.pipeline`, the pipeline of the `crfnet` command."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, partial

from crfnet.luts.lut1d import inverse_response_lut
from crfnet.pipeline import FileEstimate, anchored_exposure, estimate_files, response_lut
from crfnet.plates.frames import FrameSequence
from crfnet.plates.primaries import plate_primaries
from crfnet_core import ResponseEstimate
from crfnet_core.colorimetry import REC709, Primaries
from crfnet_core.errors import CRFNetError
from crfnet_core.photograph.image_io import read_metadata
from crfnet_core.photograph.image_io.file_kinds import file_kind
from crfnet_core.posterior import Verdict
from crfnet_core.types import Progress, show_progress

from . import writers
from .encoding_check import check_is_encoded, is_said_encoded
from .errors import AddonError, CancelledError
from .frame_files import frame_reader, frames_of, primaries_of, sample
from .job import Anchor, ApplyMode, Job
from .wording import is_loaded


@dataclass(frozen=True, eq=False)
class CompletedJob:
    """A job, its estimate and the files that it wrote."""

    job: Job
    estimate: ResponseEstimate
    stops: float  # added after the inverse response
    frames: tuple[int, ...]  # the numbers of the frames that Blender is to show; empty for a single file
    files: writers.Written | None  # None for nodes, which need no file, and if the response is not applied
    primaries: Primaries = REC709  # of the plate
    problem: AddonError | CRFNetError | None = None  # the reason why the response was estimated, but not applied
    offers: tuple[tuple[str, str], ...] = ()  # name and description of stored cameras of the plate's make and model

    @property
    def is_withheld(self) -> bool:
        """Whether the response is not applied because it is not to be trusted, and the user has not said otherwise."""
        is_wanted = self.job.output.mode is not ApplyMode.ESTIMATE
        return is_wanted and self.estimate.verdict is Verdict.DO_NOT_TRUST and not self.job.output.despite_verdict

    @property
    def is_applied(self) -> bool:
        """Whether the response is to be applied to the scene; otherwise only the estimate is stored."""
        return not (self.job.output.mode is ApplyMode.ESTIMATE or self.is_withheld or self.problem)

    @property
    def is_doubtful(self) -> bool:
        """Whether the estimate has warnings or is not to be trusted."""
        return bool(self.estimate.warnings) or self.estimate.verdict is Verdict.DO_NOT_TRUST


def run(job: Job, progress: Progress | None = None) -> CompletedJob:
    """Return a completed job; `progress` is called with (done, total) after every step, and its exception ends the job.

    Raise CRFNetError or AddonError if the plate, the model or a folder cannot be used. An error while a new estimate is
    being applied becomes the `problem` of the completed job, so that the estimate is not lost.
    """
    sequence = cache(partial(frames_of, job.plate))  # looks for the frames at most once, and only if needed
    writers.check_targets(job, sequence)
    if job.estimation.stored is not None:
        return _completed(_restored(job, job.estimation.stored, sequence), sequence, progress)
    result = estimate_plate(job, sequence(), progress)
    primaries = plate_primaries(result.firsts[0].tags).primaries or REC709
    offers = tuple((offer.name, f"{offer.name}: {offer.basis}") for offer in result.offers)
    estimated = CompletedJob(job, result.estimate, job.exposure.stops, (), None, primaries, offers=offers)
    try:
        return _completed(estimated, sequence, progress)
    except CancelledError:
        raise
    except (AddonError, CRFNetError) as problem:
        return replace(estimated, problem=problem)


def _restored(job: Job, estimate: ResponseEstimate, sequence: Callable[[], FrameSequence]) -> CompletedJob:
    """Return a job with its stored estimate; where the files of the plate are not found, its primaries are Rec.709."""
    if not job.estimation.is_forced:
        check_is_encoded(job.plate, job.plate.file, job.config)
    primaries = job.estimation.primaries or REC709
    if job.estimation.primaries is None:
        with suppress(CRFNetError):
            primaries = primaries_of(job.plate, sequence(), is_encoded=is_said_encoded(job))
    return CompletedJob(job, estimate, job.exposure.stops, (), None, primaries)


def _completed(
    estimated: CompletedJob, sequence: Callable[[], FrameSequence], progress: Progress | None
) -> CompletedJob:
    """Return a job that has its estimate with the exposure and the files that it asks for, after writing these."""
    job, estimate = estimated.job, estimated.estimate
    gray = job.exposure.gray if job.exposure.anchor is Anchor.GRAY else None
    stops = anchored_exposure(estimate.curve, gray=gray, stops=job.exposure.stops)
    completed = replace(estimated, stops=stops)
    if not completed.is_applied:
        return completed
    frames: tuple[int, ...] = ()
    if (job.plate.numbered or job.plate.frame_count) and job.output.mode is not ApplyMode.EXPORT:  # Blender shows them
        frames = tuple(range(1, job.plate.frame_count + 1)) or sequence().numbers
    files: writers.Written | None = None
    if job.output.mode is not ApplyMode.NODES:
        origin = (f"Inverse response, {estimate.model}",)
        is_estimated = not is_loaded(estimate.uncertainty)
        lut = response_lut(estimate) if is_estimated else inverse_response_lut(estimate.curve, comments=origin)
        files = writers.write(job, lut, stops, sequence, progress, primaries=estimated.primaries)
    return replace(completed, frames=frames, files=files)


def estimate_plate(job: Job, sequence: FrameSequence, progress: Progress | None = None) -> FileEstimate:
    """Return the response of a plate, estimated from its file or several of its frames.

    Unless the job forces the estimate, raise AddonError if the color space of the plate is logarithmic or linear, and
    CRFNetError if its file calls itself so. Raise CRFNetError if a file, the model or the prior cannot be read.
    """
    show_progress(progress, 0, 1)  # ends a job that was canceled before the network is loaded, which takes a second
    options, is_forced = job.estimation.options, job.estimation.is_forced
    with frame_reader(job.plate) as read:
        frames = read(sample(sequence))
        if not is_forced:
            with suppress(OSError):  # reported where the file is read
                file_kind(frames.paths[0])  # refuses formats, which Estimate Anyway does not overrule
            check_is_encoded(job.plate, frames.paths[0], job.config)
        has_metadata = options.analysis.use_metadata and job.plate.has_metadata
        is_overruled = has_metadata and is_forced and any(read_metadata(path).color.transfer for path in frames.paths)
        analysis = replace(options.analysis, use_metadata=has_metadata and not is_overruled)
        return estimate_files([frames], replace(options, analysis=analysis), progress=progress)
