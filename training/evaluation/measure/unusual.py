"""P6: pictures that must be refused, every kind of every test scene, and how often a model accepts them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from tqdm import tqdm

from crfnet_core.estimate import estimate_response
from crfnet_core.metadata import FileMetadata
from crfnet_core.network import ResponseNetwork
from crfnet_core.photo import Photo
from crfnet_core.posterior import Verdict
from training.evaluation.measure.verdict_files import VerdictFile
from training.evaluation.report.unusual import Accepted, UnusualReport
from training.evaluation.test_sets import SceneFile
from training.synthesis.unusual import UnusualKind, unusual_photo

#: The metadata of the pictures: no program or camera that makes such pictures writes the EXIF of a camera.
NO_CAMERA = FileMetadata(file_format="PNG")

#: Seed of the pictures. Each has a generator of its own, so a kind that is added last changes no other picture.
SEED = 2017


def measure_unusual(
    scenes: Sequence[SceneFile],
    models: dict[str, Path],
    files: dict[str, VerdictFile],
    *,
    kinds: Sequence[UnusualKind] = tuple(UnusualKind),
) -> None:
    """Add to the verdict files what they lack, with the prior "camera", as of files that name no camera.

    Parameters
    ----------
    scenes : sequence of SceneFile
        The scenes of the test set.
    models : dict
        Name -> folder.
    files : dict
        Name of a model -> its verdicts.
    kinds : sequence of UnusualKind
        The kinds.
    """
    labels = [label(file, kind) for file in scenes for kind in kinds]
    if all(one in file.verdicts for one in labels for file in files.values()):
        return
    networks = {name: ResponseNetwork.load(folder) for name, folder in models.items()}
    pictures = tqdm(unusual_photographs(scenes, kinds), desc="P6", total=len(labels), unit="photograph")
    for one, (_, photo) in zip(labels, pictures, strict=True):
        for name, file in files.items():
            if one not in file.verdicts:
                estimate = estimate_response(replace(photo, metadata=NO_CAMERA), network=networks[name])
                file.verdicts[one] = estimate.verdict
                file.save()


def label(file: SceneFile, kind: UnusualKind) -> str:
    """Return the label of a picture."""
    return f"{file.name}, {kind}"


def unusual_report(
    scenes: Sequence[SceneFile], file: VerdictFile, kinds: Sequence[UnusualKind] = tuple(UnusualKind)
) -> UnusualReport:
    """Return how many pictures a model accepts, from its complete verdicts."""
    by_kind = accepted_by_kind((kind, file.verdicts[label(scene, kind)]) for kind in kinds for scene in scenes)
    return UnusualReport({kind.value: counts for kind, counts in by_kind.items()}, accepted_overall(by_kind))


def unusual_photographs(
    scenes: Iterable[SceneFile], kinds: Sequence[UnusualKind] = tuple(UnusualKind), *, seed: int = SEED
) -> Iterator[tuple[UnusualKind, Photo]]:
    """Yield every kind of every scene, each rendered when it is asked for; the same arguments give the same pictures.

    Parameters
    ----------
    scenes : iterable of SceneFile
        The scenes of a test set; each is read once.
    kinds : sequence of UnusualKind
        The kinds.
    seed : int
        Of everything that is random.
    """
    numbers = {kind: number for number, kind in enumerate(UnusualKind)}
    for number, file in enumerate(scenes):
        scene = file.read()
        for kind in kinds:
            yield kind, unusual_photo(kind, scene, np.random.default_rng([seed, numbers[kind], number]))


def accepted_by_kind(verdicts: Iterable[tuple[UnusualKind, Verdict]]) -> dict[UnusualKind, Accepted]:
    """Return kind -> how many of its pictures are called "good" or "usable", in the order of the kinds.

    Parameters
    ----------
    verdicts : iterable of (UnusualKind, Verdict)
        One for each picture; a kind without any is left out.
    """
    listed = list(verdicts)
    photographs = Counter(kind for kind, _ in listed)
    accepted = Counter(kind for kind, verdict in listed if verdict != Verdict.DO_NOT_TRUST)
    return {kind: Accepted(photographs[kind], accepted[kind]) for kind in UnusualKind if photographs[kind]}


def accepted_overall(by_kind: dict[UnusualKind, Accepted]) -> Accepted:
    """Return the sum over kinds."""
    rows = by_kind.values()
    return Accepted(sum(row.photographs for row in rows), sum(row.accepted for row in rows))
