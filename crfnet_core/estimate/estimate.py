"""The method: from one photograph, or several of one camera, to its response and how far to trust it.

`estimate_response` is the whole of it on one screen; docs/METHOD.md explains each step with its equations.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from crfnet_core.errors import Notice, check_kinds
from crfnet_core.estimate.analysis import CutPhotograph, Photographs, cut_photographs, predict_evidence
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.estimate.result import ResponseEstimate, WindowEstimate
from crfnet_core.network import Predictions, ResponseNetwork
from crfnet_core.network.pooling import agreeing
from crfnet_core.photograph.metadata import Device, FileOrigin
from crfnet_core.photograph.recognition import Levels, Recognition, log_factor, recognize
from crfnet_core.photograph.thumbnail import is_noise, scene_similarities
from crfnet_core.posterior import Family, Posterior, Prior, ResponseBank, Verdict, independent_fraction
from crfnet_core.posterior.factors import metadata_factors
from crfnet_core.response.emor import EmorBasis
from crfnet_core.types import Progress

MOSTLY_CLIPPED = 0.5  # fraction of samples at the ends of the range above which a photograph counts as mostly clipped


def estimate_response(
    photos: Photographs,
    *,
    network: ResponseNetwork,
    prior: Prior | None = None,
    bank: ResponseBank | None = None,
    options: AnalysisOptions | None = None,
    progress: Progress | None = None,
) -> ResponseEstimate:
    """Estimate the response of the camera that took one or several photographs.

    Windows are cut from every photograph. The network reads them, or statistics that are counted in them, and states
    evidence: which responses make such a photograph likely. Prior times the evidence of all photographs is the
    posterior over a bank of responses, and the answer is their mean in log irradiance: the response of least expected
    squared error in stops. A network whose evidence is about whole responses answers with the mean of its windows that
    agree, as in the CRF-net paper; its posterior gives only the uncertainty.

    Parameters
    ----------
    photos : Photo, CutPhotograph, or iterable of them
        Photographs of one camera with the same settings. Of an iterator, the pixels of one photograph are in memory at
        a time, and the windows of all.
    network : ResponseNetwork
        See `ResponseNetwork.load`.
    prior : Prior, optional
        How likely each family of responses is before photographs are seen; by default the packaged prior "camera".
    bank : ResponseBank, optional
        The responses to choose from; by default the packaged ones.
    options : AnalysisOptions, optional
        How the photographs are analyzed. Photographs that are cut already keep the choices of their cutting.
    progress : callable, optional
        Called with (done, total) after every window.

    Raises
    ------
    PhotoError
        If there is no photograph, one is smaller than a window, an argument of another kind is given, or a file names
        an encoding with a published curve.
    CRFNetError
        If another argument is of another kind.
    """
    check_kinds(network=(network, ResponseNetwork), prior=(prior, Prior | None), bank=(bank, ResponseBank | None))
    check_kinds(options=(options, AnalysisOptions | None), progress=(progress, Callable | None))
    photographs = cut_photographs(photos, options)
    predictions = predict_evidence(photographs, network, progress=progress)
    origins = tuple(photograph.origin for photograph in photographs if photograph.origin is not None)
    levels = Levels.joint([photograph.levels for photograph in photographs])
    bank, prior = bank or ResponseBank.load(), _informed(prior or Prior.load(), origins, levels)
    independent = independent_fraction(scene_similarities([photograph.thumbnail for photograph in photographs]))
    evidences = [prediction.pooled for prediction in predictions]
    posterior = Posterior.from_evidences(bank, prior, evidences, independent=independent)
    recognition = recognize(
        levels,
        log_probability=posterior.families[Family.LOG],
        is_noise=all(map(_is_noise, photographs)),
        makes=tuple(photograph.make for photograph in photographs),
        origins=origins,
    )
    is_gray = all(photograph.is_gray for photograph in photographs)  # too much is accepted then: docs/ACCURACY.md
    is_doubtful = bool(recognition) or (is_gray and not any(origin.names_device for origin in origins))
    return ResponseEstimate(
        curve=posterior.curve,
        weights=EmorBasis.load().project(posterior.curve.brightness),
        windows=tuple(_window_estimates(photographs, predictions, bank, prior)),
        uncertainty=posterior.expected_error,
        shape_uncertainty=posterior.expected_shape_error,
        band=posterior.band(),
        families=posterior.families,
        verdict=Verdict.DO_NOT_TRUST if is_doubtful else Verdict.from_posterior(posterior),
        prior=prior.name,
        origins=origins,
        warnings=_warnings(photographs, origins, recognition, posterior, prior),
        model=network.config.label,
        photos=tuple(photograph.name for photograph in photographs),
        recognition=recognition,
    )


def input_warnings(recognition: Recognition | None, origins: Sequence[FileOrigin]) -> list[Notice]:
    """Return a warning of recognized photographs, and one for each program that edited or developed photographs."""
    recognized = [Notice("recognized", {"reason": recognition.reason})] if recognition else []
    editors = dict.fromkeys((origin.editor, origin.is_developed) for origin in origins if origin.editor)
    return recognized + [
        Notice("developed" if is_developed else "edited", {"editor": editor}) for editor, is_developed in editors
    ]


def _informed(prior: Prior, origins: Sequence[FileOrigin], levels: Levels) -> Prior:
    """Return the prior shifted by what the files and the user say, and by the levels of log footage."""
    log = 0.0 if any(origin.is_phone_still for origin in origins) else log_factor(levels)
    informed = prior.reweighted(metadata_factors(origins)).reweighted({Family.LOG: log})
    return replace(informed, plain=0.0) if any(origin.names_device for origin in origins) else informed


def _is_noise(photograph: CutPhotograph) -> bool:
    """Return whether a photograph shows no scene; only a file that names the camera may hold a texture."""
    has_camera = photograph.origin is not None and bool(photograph.origin.camera)
    return is_noise(photograph.thumbnail, photograph.samples, has_camera=has_camera)


def _window_estimates(
    photographs: Sequence[CutPhotograph], predictions: Sequence[Predictions], bank: ResponseBank, prior: Prior
) -> Iterator[WindowEstimate]:
    """Yield the estimate of each window alone, in the order of the photographs."""
    for number, (photograph, prediction) in enumerate(zip(photographs, predictions, strict=True)):
        agrees = agreeing(prediction.windows).tolist()
        for window, evidence, is_kept in zip(photograph.windows, prediction.windows, agrees, strict=True):
            alone = Posterior.from_evidences(bank, prior, [evidence])
            yield WindowEstimate(number, window, alone.mean_weights, alone.expected_distance, is_kept)


def _warnings(
    photographs: Sequence[CutPhotograph],
    origins: Sequence[FileOrigin],
    recognition: Recognition | None,
    posterior: Posterior,
    prior: Prior,
) -> tuple[Notice, ...]:
    """Return the reasons to expect a poor estimate."""
    cameras = list(dict.fromkeys(origin.camera for origin in origins if origin.camera))
    windows = [window for photograph in photographs for window in photograph.windows]
    several = [Notice("several_cameras", {"cameras": ", ".join(cameras)})] if len(cameras) > 1 else []
    doubts = {
        "clipped": np.mean([photograph.clipped for photograph in photographs]) > MOSTLY_CLIPPED,
        "answer_of_windows": posterior.network_answer is not None,
        "narrow_range": not any(window.covers_range for window in windows),
        "gray": all(photograph.is_gray for photograph in photographs),
        "scan": prior.name == "camera" and any(origin.device is Device.SCANNER for origin in origins),
    }
    others = [Notice(code) for code, is_so in doubts.items() if is_so]
    return (*input_warnings(recognition, origins), *several, *others)
