"""The method: from one photograph, or several of one camera, to its response and how far to trust it.

`estimate_response` is the whole of it on one screen; docs/METHOD.md explains each step with its equations.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from crfnet_core.errors import PriorError
from crfnet_core.estimate.analysis import AnalyzedPhotograph, analyze_photographs
from crfnet_core.estimate.result import ResponseEstimate, WindowEstimate
from crfnet_core.network import ResponseNetwork, pooling
from crfnet_core.photograph.metadata import Device, FileOrigin
from crfnet_core.photograph.photo import Photo
from crfnet_core.photograph.recognition import Levels, Recognition, log_factor, recognize
from crfnet_core.posterior import (
    Family,
    Posterior,
    Prior,
    ResponseBank,
    Verdict,
    independent_fraction,
    metadata_factors,
    scene_similarities,
)
from crfnet_core.response.emor import EmorBasis
from crfnet_core.statistics.windows import FULL_COVERAGE, WINDOWS_PER_PHOTOGRAPH
from crfnet_core.types import Progress

__all__ = ["ResponseEstimate", "WindowEstimate", "editor_warnings", "estimate_of", "estimate_response"]

#: Fraction of samples at the ends of the range above which a photograph counts as mostly clipped.
MOSTLY_CLIPPED = 0.5


def estimate_response(
    photos: Photo | Iterable[Photo],
    *,
    network: ResponseNetwork,
    prior: Prior | None = None,
    bank: ResponseBank | None = None,
    use_metadata: bool = True,
    device: Device | None = None,
    windows: int = WINDOWS_PER_PHOTOGRAPH,
    seed: int = 0,
    coverage: int = FULL_COVERAGE,
    progress: Progress | None = None,
) -> ResponseEstimate:
    """Estimate the response of the camera that took one or several photographs.

    Windows are cut from every photograph. The network reads them, or statistics that are counted in them, and states
    evidence: which responses make such a photograph likely. Prior times the evidence of all photographs is the
    posterior over a bank of responses, and the answer is their mean in log irradiance: the response of least expected
    squared error in stops.

    Parameters
    ----------
    photos : Photo or iterable of Photo
        Photographs of one camera with the same settings; of an iterator, one photograph is in memory
        at a time, and the windows of all.
    network : ResponseNetwork
        See `ResponseNetwork.load`.
    prior : Prior, optional
        How likely each family of responses is before photographs are seen; by default the packaged prior "camera".
    bank : ResponseBank, optional
        The responses to choose from; by default the packaged ones.
    use_metadata : bool
        Whether what the files say of their making counts: see `crfnet_core.photograph.metadata`.
    device : Device, optional
        What took them all, where somebody knows, in place of what the files say; UNKNOWN is a camera of another kind.
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
    PriorError
        If `prior` is no `Prior`.
    """
    if prior is not None and not isinstance(prior, Prior):
        raise PriorError(f"a {type(prior).__name__} is no Prior; Prior.load makes one of a name or a file")
    analyzed = analyze_photographs(
        photos,
        network=network,
        use_metadata=use_metadata,
        device=device,
        windows=windows,
        seed=seed,
        coverage=coverage,
        progress=progress,
    )
    return estimate_of(analyzed, model=network.config.label, prior=prior, bank=bank)


def estimate_of(
    photographs: Sequence[AnalyzedPhotograph],
    *,
    model: str,
    prior: Prior | None = None,
    bank: ResponseBank | None = None,
) -> ResponseEstimate:
    """Return the response of the camera that took photographs which a network has read.

    Parameters
    ----------
    photographs : sequence of AnalyzedPhotograph
        At least one; all read by one network.
    model : str
        The label of this network.
    prior, bank : Prior and ResponseBank, optional
        As of `estimate_response`.
    """
    bank = bank or ResponseBank.load()
    origins = tuple(photograph.origin for photograph in photographs if photograph.origin is not None)
    levels = Levels.joint([photograph.levels for photograph in photographs])
    prior = (prior or Prior.load()).reweighted(metadata_factors(origins)).reweighted({Family.LOG: log_factor(levels)})
    independent = independent_fraction(scene_similarities([photograph.thumbnail for photograph in photographs]))
    evidences = [photograph.evidence for photograph in photographs]
    posterior = Posterior.from_evidences(bank, prior, evidences, independent=independent)
    makes = tuple(photograph.make for photograph in photographs)
    recognition = recognize(levels, log_probability=posterior.families[Family.LOG], makes=makes, origins=origins)
    doubts = _doubts(photographs, origins)
    return ResponseEstimate(
        curve=posterior.curve,
        weights=EmorBasis.load().project(posterior.curve.brightness),
        windows=_window_estimates(photographs, bank, prior),
        uncertainty=posterior.expected_error,
        shape_uncertainty=posterior.expected_shape_error,
        band=posterior.band(),
        families=posterior.families,
        verdict=_verdict(posterior, recognition, doubts),
        prior=prior.name,
        origins=origins,
        warnings=_warnings(photographs, origins, recognition, doubts),
        model=model,
        photos=tuple(photograph.name for photograph in photographs),
        recognition=recognition,
    )


def editor_warnings(origins: Sequence[FileOrigin]) -> list[str]:
    """Return a warning for each program that edited or developed the photographs."""
    editors = dict.fromkeys((origin.editor, origin.is_developed) for origin in origins if origin.editor)
    return [_editor_warning(editor, is_developed) for editor, is_developed in editors]


def _editor_warning(editor: str, is_developed: bool) -> str:
    """Return what a program may have done to the tones, and what to give instead."""
    if is_developed:
        return (
            f"developed from a raw file by {editor}, and not by the camera: give the camera's own file, or develop the"
            " raw file to linear light, which needs no estimate"
        )
    return f"saved by {editor}, which may have changed the tones: give the camera's own file"


def _window_estimates(
    photographs: Sequence[AnalyzedPhotograph], bank: ResponseBank, prior: Prior
) -> tuple[WindowEstimate, ...]:
    """Return what each window says by itself, in the order of the photographs."""
    found = []
    for number, photo in enumerate(photographs):
        if not photo.windows:
            continue
        for window, evidence, kept in zip(
            photo.windows, photo.window_evidences, pooling.agreeing(photo.window_evidences).tolist(), strict=True
        ):
            alone = Posterior.from_evidences(bank, prior, [evidence])
            found.append(WindowEstimate(number, window, alone.mean_weights, alone.expected_distance, kept))
    return tuple(found)


def _doubts(photographs: Sequence[AnalyzedPhotograph], origins: Sequence[FileOrigin]) -> list[str]:
    """Return why an estimate cannot be good, in words; the expected errors leave it out."""
    doubts, cameras = [], list(dict.fromkeys(origin.camera for origin in origins if origin.camera))
    if len(cameras) > 1:
        doubts.append(f"photographs of different cameras ({', '.join(cameras)}): estimate each camera by itself")
    if np.mean([photograph.clipped for photograph in photographs]) > MOSTLY_CLIPPED:
        doubts.append(
            "mostly clipped: the answer is little more than the mean of cameras, so take one with another exposure"
        )
    return doubts


def _verdict(posterior: Posterior, recognition: Recognition | None, doubts: Sequence[str]) -> Verdict:
    """Return how far to trust the answer of a posterior."""
    verdict = Verdict.DO_NOT_TRUST if recognition else Verdict.from_posterior(posterior)
    return Verdict.USABLE if doubts and verdict is Verdict.GOOD else verdict


def _warnings(
    photographs: Sequence[AnalyzedPhotograph],
    origins: Sequence[FileOrigin],
    recognition: Recognition | None,
    doubts: Sequence[str],
) -> tuple[str, ...]:
    """Return what makes a poor estimate likely, in words."""
    warnings = [recognition.reason] if recognition else []
    warnings += [*editor_warnings(origins), *doubts]
    windows = [window for photograph in photographs for window in photograph.windows]
    if windows and not any(window.covers_range for window in windows):
        warnings.append("no window covers the range of brightness: expect a poor estimate")
    if all(photograph.is_gray for photograph in photographs):
        warnings.append("gray photograph: one channel says less than three, and it may be a mixture of channels")
    return tuple(warnings)
