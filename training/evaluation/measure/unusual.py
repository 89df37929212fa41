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
from crfnet_core.metadata.jpeg import ANNEX_K_CHROMA, ANNEX_K_LUMA, scaled_table
from crfnet_core.network import ResponseNetwork
from crfnet_core.photo import Photo
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

#: Seed of the pictures. Each has a generator of its own, so a kind that is added last changes no other picture.
SEED = 2017


def measure_unusual(
    scenes: Sequence[SceneFile],
    models: dict[str, Path],
    files: dict[str, VerdictFile],
    *,
    kinds: Sequence[UnusualKind] = tuple(UnusualKind),
) -> None:
    """Add to the verdict files what they lack, with the prior "camera", as their programs write files and without that.

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
    labels = {label(*one, is_stripped=way) for one in listed for way in (False, True)}
    if all(labels <= file.verdicts.keys() for file in files.values()):
        return
    networks = {name: ResponseNetwork.load(folder) for name, folder in models.items()}
    pictures = tqdm(unusual_photographs(scenes, kinds), desc="P6", total=len(listed), unit="photograph")
    for (scene, kind), (_, photo) in zip(listed, pictures, strict=True):
        written, stripped = label(scene, kind), label(scene, kind, is_stripped=True)
        files_of_picture = {written: WRITTEN.get(kind, NO_CAMERA), stripped: NO_CAMERA}
        for name, file in files.items():
            for one, metadata in files_of_picture.items():
                if one not in file.verdicts:
                    estimate = estimate_response(replace(photo, metadata=metadata), network=networks[name])
                    file.verdicts[one] = estimate.verdict
                    file.save()


def label(scene: SceneFile, kind: UnusualKind, *, is_stripped: bool = False) -> str:
    """Return the label of a picture in the file that its program writes, or in one that was stripped of metadata."""
    return f"{scene.name}, {kind}" + (", stripped" if is_stripped and kind in WRITTEN else "")


def unusual_report(
    scenes: Sequence[SceneFile], file: VerdictFile, kinds: Sequence[UnusualKind] = tuple(UnusualKind)
) -> UnusualReport:
    """Return how many pictures a model accepts, from its complete verdicts."""
    written, stripped = (
        accepted_by_kind(
            (kind, file.verdicts[label(scene, kind, is_stripped=way)]) for kind in kinds for scene in scenes
        )
        for way in (False, True)
    )
    by_kind = {kind.value: counts for kind, counts in written.items()}
    return UnusualReport(by_kind, accepted_overall(written), accepted_overall(stripped))


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
