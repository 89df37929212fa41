"""P6: pictures that must be refused, every kind of every test scene, and how often a model accepts them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from tqdm import tqdm

from crfnet_core.estimate.estimate import estimate_response
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.network import ResponseNetwork
from crfnet_core.photograph.metadata import Device, FileMetadata
from crfnet_core.photograph.metadata.jpeg import ANNEX_K_CHROMA, ANNEX_K_LUMA, scaled_table
from crfnet_core.photograph.photo import Photo
from crfnet_core.posterior import Verdict
from training.evaluation.measure.verdict_files import VerdictFile
from training.evaluation.report.unusual import Accepted, UnusualReport
from training.evaluation.test_sets import SceneFile
from training.synthesis.unusual import UnusualKind, unusual_photo
from training.synthesis.unusual.encodings import MESSENGER_QUALITY

#: The metadata of the pictures: no program or camera that makes such pictures writes the EXIF of a camera.
NO_CAMERA = FileMetadata(file_format="PNG")

#: The metadata of kinds whose programs write some: Blender's into a render; of a messenger's JPEG file a usual size and
#: the tables of the best quality.
WRITTEN = {
    UnusualKind.FILMIC: replace(NO_CAMERA, renderer="Blender"),
    UnusualKind.AGX: replace(NO_CAMERA, renderer="Blender"),
    UnusualKind.MESSENGER: FileMetadata(
        width=1600,
        height=1200,
        file_format="JPEG",
        has_jfif=True,
        luma_table=scaled_table(ANNEX_K_LUMA, MESSENGER_QUALITY[1]),
        chroma_table=scaled_table(ANNEX_K_CHROMA, MESSENGER_QUALITY[1]),
    ),
}

#: Ways of asking about a picture, as the labels end: see `ways_of_picture`.
AS_WRITTEN, STRIPPED, TOLD = "", "stripped", "camera told"

#: Seed of the pictures. Each has a generator of its own, so a kind that is added last changes no other picture.
SEED = 2017


def measure_unusual(
    scenes: Sequence[SceneFile],
    models: dict[str, Path],
    files: dict[str, VerdictFile],
    *,
    kinds: Sequence[UnusualKind] = tuple(UnusualKind),
) -> None:
    """Add to the verdict files what they lack, with the prior "camera", asked in all `ways_of_picture`.

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
    listed = [(scene, kind) for scene in scenes for kind in kinds]
    labels = {label(scene, kind, way) for scene, kind in listed for way in ways_of_picture(kind)}
    if all(labels <= file.verdicts.keys() for file in files.values()):
        return
    networks = {name: ResponseNetwork.load(folder) for name, folder in models.items()}
    pictures = tqdm(unusual_photographs(scenes, kinds), desc="P6", total=len(listed), unit="photograph")
    for (scene, kind), (_, photo) in zip(listed, pictures, strict=True):
        for name, file in files.items():
            for way, (metadata, device) in ways_of_picture(kind).items():
                if (one := label(scene, kind, way)) not in file.verdicts:
                    asked = replace(photo, metadata=metadata)
                    file.verdicts[one] = estimate_response(
                        asked, network=networks[name], options=AnalysisOptions(device=device)
                    ).verdict
                    file.save()


def ways_of_picture(kind: UnusualKind) -> dict[str, tuple[FileMetadata, Device | None]]:
    """Return way of asking about a picture -> the metadata of its file, and what the user says took it.

    They are: as its program writes it; without any metadata; and the same by a user who says that a camera took it.
    """
    return {
        AS_WRITTEN: (WRITTEN.get(kind, NO_CAMERA), None),
        **({STRIPPED: (NO_CAMERA, None)} if kind in WRITTEN else {}),
        TOLD: (NO_CAMERA, Device.CAMERA),
    }


def label(scene: SceneFile, kind: UnusualKind, way: str) -> str:
    """Return the label of a picture that is asked about in a way; see `ways_of_picture`."""
    return f"{scene.name}, {kind}" + (f", {way}" if way else "")


def unusual_report(
    scenes: Sequence[SceneFile], file: VerdictFile, kinds: Sequence[UnusualKind] = tuple(UnusualKind)
) -> UnusualReport:
    """Return how many pictures a model accepts, from its complete verdicts."""
    written, stripped, told = (
        accepted_by_kind(
            (kind, file.verdicts[label(scene, kind, way if way in ways_of_picture(kind) else AS_WRITTEN)])
            for kind in kinds
            for scene in scenes
        )
        for way in (AS_WRITTEN, STRIPPED, TOLD)
    )
    by_kind = {kind.value: counts for kind, counts in written.items()}
    return UnusualReport(by_kind, *map(accepted_overall, (written, stripped, told)))


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
