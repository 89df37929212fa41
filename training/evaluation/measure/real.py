"""P4: measure real photographs, as the product reads them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

from tqdm import tqdm

from crfnet_core.estimate.estimate import estimate_response
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.network import ResponseNetwork
from crfnet_core.photograph.image_io import read_photo
from crfnet_core.photograph.metadata import Device, FileMetadata
from crfnet_core.photograph.photo import Photo
from crfnet_core.posterior import ResponseBank
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.types import Float64Array
from training.data.real.photographs import RealPhotograph, real_photographs
from training.data.response_bank import make_bank
from training.evaluation.baselines import (
    BASELINES,
    ORACLE_DORF,
    ORACLE_HEADROOM,
    OTHER_BODIES,
    constant_curves,
    mean_in_log_irradiance,
    nearest_of,
    with_best_headroom,
)
from training.evaluation.measure.case_files import CaseFile
from training.evaluation.measure.figures import all_baselines, model_figures
from training.evaluation.report.real.content import ways_of
from training.synthesis.camera import code_counts


def measure_real(
    photographs: Sequence[RealPhotograph],
    models: dict[str, Path],
    files: dict[str, CaseFile],
    known: Float64Array,
    data: Path,
    *,
    title: str = "P4",
) -> None:
    """Add to the case files what they lack; a photograph is read once for all models.

    Parameters
    ----------
    photographs : sequence of RealPhotograph
        All photographs of a folder.
    models : dict
        Name -> folder.
    files : dict
        Name of a model, or `BASELINES` -> its figures.
    known : ndarray, shape (N, 1024)
        Responses for the constant baselines, and for the oracle that picks the nearest; those of DoRF.
    data : Path
        The data folder. The bank that a photograph is estimated with knows nothing of the bodies of its fold.
    title : str
        Of the progress bar.
    """
    wanted = [
        photograph for photograph in photographs if any(photograph.name not in file.rows for file in files.values())
    ]
    if not wanted:
        return
    constants = constant_curves(known)
    truths = {photograph.measured: photograph.truth() for photograph in photographs}
    networks = {name: ResponseNetwork.load(folder) for name, folder in models.items()}
    for photograph in tqdm(wanted, desc=title, unit="photograph"):
        photo, true = read_real_photo(photograph), truths[photograph.measured]
        counts = code_counts(photo)
        for name, file in files.items():
            if photograph.name in file.rows:
                continue
            if name == BASELINES:
                others = mean_of_other_bodies(photograph, photographs, truths)
                curves = constants | _of_real_cameras(others, true, known)
                file.rows[photograph.name] = all_baselines(true, counts, curves)
            else:
                answers = estimates([photo], photograph.kind, networks[name], bank_without_fold(photograph, data))
                file.rows[photograph.name] = {
                    way: model_figures(true, answer, counts, is_drawn=True)
                    for way, answer in zip(ways_of(name), answers, strict=True)
                }
            file.save()


def read_real_photo(photograph: RealPhotograph) -> Photo:
    """Return the photograph as the product reads it, with the metadata of its original where the file lost it."""
    photo = read_photo(photograph.photograph)
    return replace(photo, metadata=photograph.metadata or photo.metadata)


def estimates(
    photos: Sequence[Photo], kind: str, network: ResponseNetwork, bank: ResponseBank
) -> list[ResponseEstimate]:
    """Return the estimates from photographs of one body of a `RealPhotograph.kind`, in the order of `ways_of`."""
    told, lost = AnalysisOptions(device=Device(kind) if kind in set(Device) else None), list(map(without_exif, photos))
    estimate = partial(estimate_response, network=network, bank=bank)
    return [
        estimate(photos),
        estimate(lost),
        estimate(lost, options=told),
        estimate(photos, options=AnalysisOptions(use_metadata=False)),
    ]


def without_exif(photo: Photo) -> Photo:
    """Return the photograph as a web site sends it: its file says nothing but the size of the picture."""
    height, width = photo.pixels.shape[:2]
    return replace(photo, metadata=FileMetadata(width=width, height=height, file_format="WebP"))


def bank_without_fold(photograph: RealPhotograph, data: Path) -> ResponseBank:
    """Return the bank without the bodies of the photograph's fold, made once for each fold."""
    return _bank_of_fold(photograph.photograph.parents[1], photograph.fold, data)


@cache
def _bank_of_fold(folder: Path, fold: str, data: Path) -> ResponseBank:
    """Return the bank without the bodies of a fold of a folder."""
    members = [photograph for photographs in real_photographs(data).values() for photograph in photographs]
    first = next(one for one in members if one.photograph.parents[1] == folder and one.fold == fold)
    return make_bank(data, without=first)


def _of_real_cameras(others: ResponseCurve, true: ResponseCurve, known: Float64Array) -> dict[str, ResponseCurve]:
    """Return the mean of the other bodies, and what an oracle makes of it and of the known responses, by name."""
    return {
        OTHER_BODIES: others,
        ORACLE_HEADROOM: with_best_headroom(others, true),
        ORACLE_DORF: nearest_of(known, true),
    }


def mean_of_other_bodies(
    photograph: RealPhotograph, photographs: Sequence[RealPhotograph], truths: dict[Path, ResponseCurve]
) -> ResponseCurve:
    """Return the mean response, in log irradiance, of the bodies of the other folds, each body counted once.

    This is the estimate of someone who knows cameras and does not look at the photograph. Responses of DATA/real_bodies
    that need caution are no part of it. Where there is no other body it is gamma 2.2.

    Parameters
    ----------
    photograph : RealPhotograph
        Whose fold is left out.
    photographs : sequence of RealPhotograph
        All of the folder.
    truths : dict
        File of a measured response -> response.
    """
    bodies: dict[str, dict[Path, ResponseCurve]] = {}
    for other in photographs:
        if other.is_in_mean and other.fold != photograph.fold:
            bodies.setdefault(other.body_key, {})[other.measured] = truths[other.measured]
    if not bodies:
        return ResponseCurve.gamma(2.2)
    return mean_in_log_irradiance([mean_in_log_irradiance(list(curves.values())) for curves in bodies.values()])
