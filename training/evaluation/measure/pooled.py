"""P4, several photographs of one body: what the product says when it is given them together."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from tqdm import tqdm

from crfnet_core.network import ResponseNetwork
from training.data.real.photographs import RealPhotograph
from training.evaluation.measure.case_files import CaseFile
from training.evaluation.measure.figures import model_figures
from training.evaluation.measure.real import bank_without_fold, estimates, read_real_photo
from training.evaluation.report.real.content import ways_of
from training.synthesis.camera import code_counts

#: The most photographs that are given together, and the fewest.
MOST_POOLED, LEAST_POOLED = 4, 2


def pooled_groups(photographs: Sequence[RealPhotograph]) -> list[list[RealPhotograph]]:
    """Return the photographs of each body that are given together, of the bodies that have `LEAST_POOLED` or more.

    Of more than `MOST_POOLED` those at even steps through the list are taken: neighbours in it are of one scene.
    """
    bodies: dict[str, list[RealPhotograph]] = {}
    for photograph in photographs:
        bodies.setdefault(photograph.body_key, []).append(photograph)
    return [_evenly(members) for members in bodies.values() if len(members) >= LEAST_POOLED]


def _evenly(members: list[RealPhotograph]) -> list[RealPhotograph]:
    """Return at most `MOST_POOLED` photographs, at even steps."""
    steps = np.linspace(0, len(members) - 1, min(len(members), MOST_POOLED)).round().astype(int)
    return [members[step] for step in steps]


def measure_pooled(
    photographs: Sequence[RealPhotograph],
    models: dict[str, Path],
    files: dict[str, CaseFile],
    data: Path,
    *,
    title: str = "P4, pooled",
) -> None:
    """Add to the case files what they lack: the answer for a body, measured on each of the photographs given.

    Every photograph has the response of its own exposure stack.

    Parameters
    ----------
    photographs : sequence of RealPhotograph
        All photographs of a folder.
    models : dict
        Name -> folder.
    files : dict
        Name of a model -> its figures.
    data : Path
        The data folder; see `measure_real`.
    title : str
        Of the progress bar.
    """
    groups = [
        group
        for group in pooled_groups(photographs)
        if any(photograph.name not in file.rows for file in files.values() for photograph in group)
    ]
    networks = {name: ResponseNetwork.load(models[name]) for name in files if groups}
    for group in tqdm(groups, desc=title, unit="body", disable=not groups):
        photos, bank = [read_real_photo(photograph) for photograph in group], bank_without_fold(group[0], data)
        for name, file in files.items():
            answers = estimates(photos, group[0].kind, networks[name], bank)
            for photograph, photo in zip(group, photos, strict=True):
                true, counts = photograph.truth(), code_counts(photo)
                file.rows[photograph.name] = {
                    way: model_figures(true, answer, counts) for way, answer in zip(ways_of(name), answers, strict=True)
                }
            file.save()
