"""Measure real photographs (P4), each alone and several of one body together, as the product reads them."""

from collections.abc import Iterator, Sequence
from functools import cache, partial
from itertools import product
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
from training.data.real_photographs import RealPhotograph
from training.data.response_bank import make_bank
from training.evaluation import baselines
from training.evaluation.measure.figures import curve_figures, estimate_figures, first_weights
from training.evaluation.measure.table import Row, Table
from training.evaluation.models import Model, load_network
from training.evaluation.test_sets import TestSet
from training.synthesis.camera import code_counts

#: The most photographs of a body that are estimated together, and the fewest.
MOST_POOLED, LEAST_POOLED = 4, 2

#: The bank without the bodies of a fold, made once for each.
cached_bank = cache(make_bank)

#: What follows the name of a protocol whose photographs are estimated together.
POOLED = ", pooled"

#: What follows a model's name: asked with the file's metadata; after its loss; after its loss, with the kind of camera
#: stated; without any metadata.
WAYS = ("", ", EXIF lost", ", EXIF lost, kind stated", ", metadata ignored")


def measure_real(
    protocol: str, photographs: Sequence[RealPhotograph], models: Sequence[Model], table: Table, test_set: TestSet
) -> None:
    """Add to the table what it lacks of a folder: baselines, and models on photographs alone and several of a body.

    The bank that a photograph is estimated with knows nothing of the bodies of its fold.
    """
    assert test_set.data is not None
    _measure_baselines(protocol, photographs, table, test_set)
    _measure_models(protocol, [[photograph] for photograph in photographs], models, table, test_set.data)
    _measure_models(protocol + POOLED, pooled_groups(photographs), models, table, test_set.data)


def _measure_baselines(protocol: str, photographs: Sequence[RealPhotograph], table: Table, test_set: TestSet) -> None:
    """Add the baselines that the table lacks."""
    wanted = [photograph for photograph in photographs if table.lacks(protocol, photograph.name, baselines.GAMMA)]
    truths = {photograph.measured: photograph.truth() for photograph in photographs if wanted}
    for photograph in wanted:
        counts, true = code_counts(read_real_photo(photograph)), truths[photograph.measured]
        others = mean_of_other_bodies(photograph, photographs, truths)
        curves = baselines.constant_curves() | {
            baselines.OTHER_BODIES: others,
            "oracle: mean of the other bodies, best headroom": baselines.with_best_headroom(others, true),
            "oracle: nearest curve of DoRF": baselines.nearest_of(test_set.curves, true),
        }
        curves |= baselines.oracle_curves(true)
        figures = {name: curve_figures(true, curve, counts) for name, curve in curves.items()}
        table.add(_rows(protocol, photograph, true, "", figures))


def _measure_models(
    protocol: str, groups: Sequence[Sequence[RealPhotograph]], models: Sequence[Model], table: Table, data: Path
) -> None:
    """Add what the table lacks: the answer for each group of one body, measured on each photograph of the group.

    Every photograph has the response of its own exposure stack. A photograph is read once for all models.
    """

    def lacks(model: Model, group: Sequence[RealPhotograph]) -> bool:
        rows = product(group, WAYS)
        return any(table.lacks(protocol, photograph.name, model.name + way, model.key) for photograph, way in rows)

    for group in tqdm(groups, desc=protocol, unit="group"):
        if not (lacking := [model for model in models if lacks(model, group)]):
            continue
        photos, bank = [read_real_photo(photograph) for photograph in group], cached_bank(data, without=group[0].fold)
        for model in lacking:
            answers = estimates(photos, group[0].kind, load_network(model), bank)
            for photograph, photo in zip(group, photos, strict=True):
                true, counts = photograph.truth(), code_counts(photo)
                figures = {
                    model.name + way: estimate_figures(true, answer, counts)
                    for way, answer in zip(WAYS, answers, strict=True)
                }
                table.add(_rows(protocol, photograph, true, model.key, figures))


def pooled_groups(photographs: Sequence[RealPhotograph]) -> list[list[RealPhotograph]]:
    """Return the photographs of each body that are estimated together, of the bodies with `LEAST_POOLED` or more.

    Of more than `MOST_POOLED` those at even steps through the list are taken: neighbors in it are of one scene.
    """
    bodies: dict[str, list[RealPhotograph]] = {}
    for photograph in photographs:
        bodies.setdefault(photograph.body_key, []).append(photograph)
    groups = []
    for members in bodies.values():
        if len(members) >= LEAST_POOLED:
            steps = np.linspace(0, len(members) - 1, min(len(members), MOST_POOLED)).round().astype(int)
            groups.append([members[step] for step in steps])
    return groups


def _rows(
    protocol: str, photograph: RealPhotograph, true: ResponseCurve, model: str, figures: dict[str, dict[str, Any]]
) -> Iterator[Row]:
    """Yield the rows of a photograph, one for each estimator in `figures`; `model` is empty for baselines."""
    columns = {
        "body": photograph.body,
        "body key": photograph.body_key,
        "kind": photograph.kind,
        "grade": photograph.grade,
        "caution": photograph.caution,
        "true weights": first_weights(true),
    }
    for name, row in figures.items():
        key = {"protocol": protocol, "photograph": photograph.name, "estimator": name, "model": model}
        yield key | columns | row


def read_real_photo(photograph: RealPhotograph) -> Photo:
    """Return the photograph as the product reads it, with the metadata of its original where the file lost it."""
    photo = read_photo(photograph.photograph)
    return photo.with_metadata(photograph.metadata or photo.metadata)


def estimates(
    photos: Sequence[Photo], kind: str, network: ResponseNetwork, bank: ResponseBank
) -> list[ResponseEstimate]:
    """Return the estimates from photographs of one body of a `RealPhotograph.kind`, in the order of `WAYS`."""
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


def mean_of_other_bodies(
    photograph: RealPhotograph, photographs: Sequence[RealPhotograph], truths: dict[Path, ResponseCurve]
) -> ResponseCurve:
    """Return the mean response, in log irradiance, of the bodies of the other folds, each body counted once.

    It stands for someone who knows cameras and does not look at the photograph. Responses that need caution are left
    out; without another body it is gamma 2.2. `truths` has the response of each file of `photographs`.
    """
    bodies: dict[str, dict[Path, ResponseCurve]] = {}
    for other in photographs:
        if other.is_in_mean and other.fold != photograph.fold:
            bodies.setdefault(other.body_key, {})[other.measured] = truths[other.measured]
    if not bodies:
        return ResponseCurve.gamma(2.2)
    means = [baselines.mean_in_log_irradiance(list(curves.values())) for curves in bodies.values()]
    return baselines.mean_in_log_irradiance(means)
