"""Measure P6: pictures that must be refused, every kind of every test scene, and whether a model accepts them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from tqdm import tqdm

from crfnet_core.estimate.estimate import estimate_response
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.network import ResponseNetwork
from crfnet_core.photograph.metadata import Device, FileMetadata
from crfnet_core.photograph.metadata.jpeg import ANNEX_K_CHROMA, ANNEX_K_LUMA, scaled_table
from crfnet_core.photograph.photo import Photo
from training.evaluation.measure.table import Table
from training.evaluation.models import Model
from training.evaluation.test_sets import SceneFile
from training.synthesis.unusual import UnusualKind, unusual_photo
from training.synthesis.unusual.encodings import MESSENGER_QUALITY

#: The name in the table.
PROTOCOL = "P6"

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


def ways_of(model: str) -> list[str]:
    """Return the names of the ways in which P6 asks a model.

    They are: with the metadata that the picture's program writes; without any; without any, by a user who states,
    rightly or wrongly, that a camera took the picture.
    """
    return [model, f"{model}, without metadata", f"{model}, without metadata, a camera stated"]


def label(scene: SceneFile, kind: UnusualKind) -> str:
    """Return the name of a picture in the table."""
    return f"{scene.name}, {kind}"


def measure_unusual(
    scenes: Sequence[SceneFile],
    models: Sequence[Model],
    table: Table,
    *,
    kinds: Sequence[UnusualKind] = tuple(UnusualKind),
) -> None:
    """Add to the table what it lacks, with the prior "camera", asked in all `ways_of`.

    `scenes`: the scenes of the test set.
    """
    listed = [(scene, kind) for scene in scenes for kind in kinds]
    if not any(_lacks(table, model, *each) for model in models for each in listed):
        return
    networks = {model: ResponseNetwork.load(model.folder) for model in models}
    pictures = tqdm(unusual_photographs(scenes, kinds), desc=PROTOCOL, total=len(listed), unit="photograph")
    for (scene, kind), (_, photo) in zip(listed, pictures, strict=True):
        for model, network in networks.items():
            if _lacks(table, model, scene, kind):
                rows = zip(ways_of(model.name), _verdicts(photo, kind, network), strict=True)
                common = {"protocol": PROTOCOL, "photograph": label(scene, kind), "model": model.key}
                columns = {"scene": scene.name, "kind": kind.value}
                table.add(common | {"estimator": way, "verdict": verdict} | columns for way, verdict in rows)


def _lacks(table: Table, model: Model, scene: SceneFile, kind: UnusualKind) -> bool:
    """Return whether a model has to be asked about a picture."""
    return any(table.lacks(PROTOCOL, label(scene, kind), way, model.key) for way in ways_of(model.name))


def _verdicts(photo: Photo, kind: UnusualKind, network: ResponseNetwork) -> list[str]:
    """Return the verdicts on a picture, in the order of `ways_of`."""

    def verdict(metadata: FileMetadata, device: Device | None = None) -> str:
        options = AnalysisOptions(device=device)
        return str(estimate_response(photo.with_metadata(metadata), network=network, options=options).verdict)

    stripped = verdict(NO_CAMERA)
    written = verdict(WRITTEN[kind]) if kind in WRITTEN else stripped
    return [written, stripped, verdict(NO_CAMERA, Device.CAMERA)]


def unusual_photographs(
    scenes: Iterable[SceneFile], kinds: Sequence[UnusualKind] = tuple(UnusualKind), *, seed: int = SEED
) -> Iterator[tuple[UnusualKind, Photo]]:
    """Yield every kind of every scene, each rendered when it is asked for; the same arguments give the same pictures.

    `scenes`: the scenes of a test set; each is read once. `seed`: of everything that is random.
    """
    numbers = {kind: number for number, kind in enumerate(UnusualKind)}
    for number, file in enumerate(scenes):
        scene = file.read()
        for kind in kinds:
            yield kind, unusual_photo(kind, scene, np.random.default_rng([seed, numbers[kind], number]))
