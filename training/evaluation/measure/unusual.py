"""Measure P6: pictures that must be refused, every kind of every test scene, and whether a model accepts them."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from tqdm import tqdm

from crfnet_core.estimate.estimate import estimate_response
from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.network import ResponseNetwork
from crfnet_core.photograph.metadata import Device, FileMetadata
from crfnet_core.photograph.metadata.jpeg import ANNEX_K_CHROMA, ANNEX_K_LUMA, scaled_table
from crfnet_core.photograph.photo import Photo
from training.evaluation.measure.table import Row, Table
from training.evaluation.models import Model, load_network
from training.evaluation.plan import SEED
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

#: What follows a model's name: asked with the metadata that the picture's program writes; without any; without any, by
#: a user who states, rightly or wrongly, that a camera took the picture.
WAYS = ("", ", without metadata", ", without metadata, a camera stated")


def label(scene: SceneFile, kind: UnusualKind) -> str:
    """Return the name of a picture in the table."""
    return f"{scene.name}, {kind}"


def measure_unusual(scenes: Sequence[SceneFile], models: Sequence[Model], table: Table) -> None:
    """Add to the table what it lacks of every kind of every scene, with the prior "camera", asked in all `WAYS`.

    A picture has a random generator of its own, so a kind that is added last changes no other picture.
    """
    for number, file in enumerate(tqdm(scenes, desc=PROTOCOL, unit="scene")):
        lacking = {kind: [model for model in models if _lacks(table, file, kind, model)] for kind in UnusualKind}
        if not any(lacking.values()):
            continue
        scene = file.read()
        for place, (kind, asked) in enumerate(lacking.items()):
            if asked:
                photo = unusual_photo(kind, scene, np.random.default_rng([SEED, place, number]))
                table.add(row for model in asked for row in _rows(photo, file, kind, model))


def _lacks(table: Table, scene: SceneFile, kind: UnusualKind, model: Model) -> bool:
    """Return whether a model has to be asked about a picture."""
    return any(table.lacks(PROTOCOL, label(scene, kind), model.name + way, model.key) for way in WAYS)


def _rows(photo: Photo, scene: SceneFile, kind: UnusualKind, model: Model) -> Iterator[Row]:
    """Yield the rows of a picture: the verdicts of a model, asked in all `WAYS`."""
    columns = {"photograph": label(scene, kind), "model": model.key, "kind": kind.value}
    for way, verdict in zip(WAYS, _verdicts(photo, kind, load_network(model)), strict=True):
        yield {"protocol": PROTOCOL, "estimator": model.name + way, "verdict": verdict} | columns


def _verdicts(photo: Photo, kind: UnusualKind, network: ResponseNetwork) -> list[str]:
    """Return the verdicts on a picture, in the order of `WAYS`."""

    def verdict(metadata: FileMetadata, device: Device | None = None) -> str:
        options = AnalysisOptions(device=device)
        return str(estimate_response(photo.with_metadata(metadata), network=network, options=options).verdict)

    stripped = verdict(NO_CAMERA)
    written = verdict(WRITTEN[kind]) if kind in WRITTEN else stripped
    return [written, stripped, verdict(NO_CAMERA, Device.CAMERA)]
