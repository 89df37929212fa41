"""P4: measure real photographs, as the product reads them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from tqdm import tqdm

from crfnet_core.estimate import estimate_response
from crfnet_core.image_io import read_photo
from crfnet_core.network import ResponseNetwork
from crfnet_core.types import Float64Array
from training.evaluation.baselines import BASELINES, OTHER_BODIES, constant_curves
from training.evaluation.measure.case_files import CaseFile
from training.evaluation.measure.figures import all_baselines, model_figures
from training.evaluation.measure.real_photographs import RealPhotograph, mean_of_other_bodies
from training.synthesis.camera import code_counts


def measure_real(
    photographs: Sequence[RealPhotograph],
    models: dict[str, Path],
    files: dict[str, CaseFile],
    known: Float64Array,
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
        Responses for the constant baselines.
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
        photo, true = read_photo(photograph.photograph), truths[photograph.measured]
        counts = code_counts(photo)
        for name, file in files.items():
            if photograph.name in file.rows:
                continue
            if name == BASELINES:
                others = {OTHER_BODIES: mean_of_other_bodies(photograph, photographs, truths)}
                file.rows[photograph.name] = all_baselines(true, counts, constants | others)
            else:
                estimate = estimate_response(photo, network=networks[name])
                file.rows[photograph.name] = {name: model_figures(true, estimate, counts, is_drawn=True)}
            file.save()
