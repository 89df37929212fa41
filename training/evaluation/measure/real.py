"""Measure real photographs (P4), each alone and several of one body together, as the product reads them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
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
from training.data.real.photographs import RealPhotograph, real_photographs
from training.data.response_bank import make_bank
from training.evaluation.baselines import (
    GAMMA,
    ORACLE_DORF,
    ORACLE_HEADROOM,
    OTHER_BODIES,
    mean_in_log_irradiance,
    nearest_of,
    oracle_curves,
    with_best_headroom,
)
from training.evaluation.measure.figures import curve_figures, estimate_figures, first_weights
from training.evaluation.measure.table import Row, Table
from training.evaluation.models import Model
from training.evaluation.test_sets import TestSet
from training.synthesis.camera import code_counts

#: The most photographs of a body that are estimated together, and the fewest.
MOST_POOLED, LEAST_POOLED = 4, 2

#: What follows the name of a protocol whose photographs are estimated together.
POOLED = ", pooled"


def ways_of(model: str) -> list[str]:
    """Return the names of the ways in which P4 asks a model.

    They are: with the file's metadata; after its loss; after its loss, with the kind of camera stated; without any
    metadata.
    """
    return [model, f"{model}, EXIF lost", f"{model}, EXIF lost, kind stated", f"{model}, metadata ignored"]


def measure_real(
    protocol: str, photographs: Sequence[RealPhotograph], models: Sequence[Model], table: Table, test_set: TestSet
) -> None:
    """Add to the table what it lacks; a photograph is read once for all models.

    `photographs`: all photographs of a folder. `test_set`: the responses of DoRF, for the baselines, and the data
    folder. The bank that a photograph is estimated with knows nothing of the bodies of its fold.
    """
    wanted = [
        photograph
        for photograph in photographs
        if table.lacks(protocol, photograph.name, GAMMA) or _lacking(protocol, photograph, models, table)
    ]
    truths = {photograph.measured: photograph.truth() for photograph in photographs if wanted}
    for photograph in tqdm(wanted, desc=protocol, unit="photograph", disable=not wanted):
        photo, true = read_real_photo(photograph), truths[photograph.measured]
        counts, row = code_counts(photo), partial(_row, protocol, photograph, true)
        if table.lacks(protocol, photograph.name, GAMMA):
            others = mean_of_other_bodies(photograph, photographs, truths)
            curves = test_set.constants | {OTHER_BODIES: others, ORACLE_HEADROOM: with_best_headroom(others, true)}
            curves |= {ORACLE_DORF: nearest_of(test_set.curves, true)} | oracle_curves(true)
            table.add(row(name, "", curve_figures(true, curve, counts)) for name, curve in curves.items())
        for model in _lacking(protocol, photograph, models, table):
            answers = estimates([photo], photograph.kind, _network(model), bank_without_fold(photograph, test_set))
            ways = zip(ways_of(model.name), answers, strict=True)
            table.add(row(way, model.key, estimate_figures(true, answer, counts)) for way, answer in ways)


def measure_pooled(
    protocol: str, photographs: Sequence[RealPhotograph], models: Sequence[Model], table: Table, test_set: TestSet
) -> None:
    """Add to the table what it lacks: the answer for a body, measured on each of the photographs that it is made of.

    Every photograph has the response of its own exposure stack. For the parameters see `measure_real`.
    """
    for group in pooled_groups(photographs):
        for model in models:
            if not any(_lacking(protocol, photograph, [model], table) for photograph in group):
                continue
            photos, bank = [read_real_photo(photograph) for photograph in group], bank_without_fold(group[0], test_set)
            answers = estimates(photos, group[0].kind, _network(model), bank)
            for photograph, photo in zip(group, photos, strict=True):
                true, counts = photograph.truth(), code_counts(photo)
                ways = zip(ways_of(model.name), answers, strict=True)
                table.add(
                    _row(protocol, photograph, true, way, model.key, estimate_figures(true, answer, counts))
                    for way, answer in ways
                )


def pooled_groups(photographs: Sequence[RealPhotograph]) -> list[list[RealPhotograph]]:
    """Return the photographs of each body that are estimated together, of the bodies with `LEAST_POOLED` or more.

    Of more than `MOST_POOLED` those at even steps through the list are taken: neighbors in it are of one scene.
    """
    bodies: dict[str, list[RealPhotograph]] = {}
    for photograph in photographs:
        bodies.setdefault(photograph.body_key, []).append(photograph)
    return [_evenly(members) for members in bodies.values() if len(members) >= LEAST_POOLED]


def _evenly(members: list[RealPhotograph]) -> list[RealPhotograph]:
    """Return at most `MOST_POOLED` photographs, at even steps."""
    steps = np.linspace(0, len(members) - 1, min(len(members), MOST_POOLED)).round().astype(int)
    return [members[step] for step in steps]


def _lacking(protocol: str, photograph: RealPhotograph, models: Sequence[Model], table: Table) -> list[Model]:
    """Return the models that have to be asked about a photograph."""
    return [
        model
        for model in models
        if any(table.lacks(protocol, photograph.name, way, model.key) for way in ways_of(model.name))
    ]


def _row(
    protocol: str, photograph: RealPhotograph, true: ResponseCurve, estimator: str, model: str, figures: dict[str, Any]
) -> Row:
    """Return a row of the table."""
    return {
        "protocol": protocol,
        "photograph": photograph.name,
        "estimator": estimator,
        "model": model,
        "body": photograph.body,
        "body key": photograph.body_key,
        "kind": photograph.kind,
        "grade": photograph.grade,
        "caution": photograph.caution,
        "true weights": first_weights(true),
    } | figures


def read_real_photo(photograph: RealPhotograph) -> Photo:
    """Return the photograph as the product reads it, with the metadata of its original where the file lost it."""
    photo = read_photo(photograph.photograph)
    return photo.with_metadata(photograph.metadata or photo.metadata)


def estimates(
    photos: Sequence[Photo], kind: str, network: ResponseNetwork, bank: ResponseBank
) -> list[ResponseEstimate]:
    """Return the estimates from photographs of one body of a `RealPhotograph.kind`, in the order of `ways_of`."""
    device, lost = (Device(kind) if kind in set(Device) else None), [without_exif(photo) for photo in photos]
    estimate = partial(estimate_response, network=network, bank=bank)
    return [
        estimate(photos),
        estimate(lost),
        estimate(lost, options=AnalysisOptions(device=device)),
        estimate(photos, options=AnalysisOptions(use_metadata=False)),
    ]


def without_exif(photo: Photo) -> Photo:
    """Return the photograph as a web site sends it: its file states only the size of the picture."""
    height, width = photo.pixels.shape[:2]
    return photo.with_metadata(FileMetadata(width=width, height=height, file_format="WebP"))


def bank_without_fold(photograph: RealPhotograph, test_set: TestSet) -> ResponseBank:
    """Return the bank without the bodies of the photograph's fold, made once for each fold."""
    assert test_set.data is not None
    return _bank_of_fold(photograph.photograph.parents[1], photograph.fold, test_set.data)


@cache
def _bank_of_fold(folder: Path, fold: str, data: Path) -> ResponseBank:
    """Return the bank without the bodies of a fold of a folder."""
    members = [photograph for photographs in real_photographs(data).values() for photograph in photographs]
    first = next(one for one in members if one.photograph.parents[1] == folder and one.fold == fold)
    return make_bank(data, without=first)


@cache
def _network(model: Model) -> ResponseNetwork:
    """Return a model's network, loaded once."""
    return ResponseNetwork.load(model.folder)


def mean_of_other_bodies(
    photograph: RealPhotograph, photographs: Sequence[RealPhotograph], truths: dict[Path, ResponseCurve]
) -> ResponseCurve:
    """Return the mean response, in log irradiance, of the bodies of the other folds, each body counted once.

    This is the estimate of someone who knows cameras and does not look at the photograph. Responses of DATA/real_bodies
    that need caution are left out of it. Without another body it is gamma 2.2.

    `photograph`: its fold is left out. `photographs`: all of the folder. `truths`: file of a measured response ->
    response.
    """
    bodies: dict[str, dict[Path, ResponseCurve]] = {}
    for other in photographs:
        if other.is_in_mean and other.fold != photograph.fold:
            bodies.setdefault(other.body_key, {})[other.measured] = truths[other.measured]
    if not bodies:
        return ResponseCurve.gamma(2.2)
    return mean_in_log_irradiance([mean_in_log_irradiance(list(curves.values())) for curves in bodies.values()])
