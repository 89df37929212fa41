from types import SimpleNamespace

import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")

from crfnet_core.photograph.metadata import Device, FileMetadata
from crfnet_core.posterior import Verdict
from training.evaluation.measure.table import Cases, Table
from training.evaluation.measure.unusual import WRITTEN, label, measure_unusual, unusual_photographs, ways_of
from training.evaluation.models import Model
from training.evaluation.report.sums import unusual_rows
from training.synthesis.unusual import UnusualKind


class File:
    """A scene file that counts how often it is read."""

    def __init__(self, scene, name="made"):
        self.scene, self.name, self.read_count = scene, name, 0

    def read(self):
        self.read_count += 1
        return self.scene


def test_every_kind_of_every_scene_comes_once_and_lazily(scene):
    files = [File(scene), File(scene)]
    pairs = unusual_photographs(files)
    assert files[0].read_count == 0
    first_kind, _ = next(pairs)
    assert (files[0].read_count, files[1].read_count) == (1, 0)
    assert [first_kind, *(kind for kind, _ in pairs)] == [*UnusualKind] * 2


def test_p6_asks_once_with_what_programs_write_without_it_and_with_a_camera_stated(
    scene, fixed_model, tmp_path, monkeypatch
):
    asked = []

    def estimate(photo, *, network, options):
        asked.append((photo.metadata, options.device))
        return SimpleNamespace(verdict=Verdict.USABLE if "solarized" in str(photo.path) else Verdict.DO_NOT_TRUST)

    monkeypatch.setattr("training.evaluation.measure.unusual.estimate_response", estimate)
    kinds, scenes = (UnusualKind.SOLARIZED, UnusualKind.MESSENGER), [File(scene, "a"), File(scene, "b")]
    model, table = Model.find(str(fixed_model)), Table(tmp_path / "table", {}, "c")
    measure_unusual(scenes, [model], table, kinds=kinds)
    stripped = FileMetadata(file_format="PNG")
    solarized = [(stripped, None), (stripped, Device.CAMERA)]
    messenger = [(stripped, None), (WRITTEN[UnusualKind.MESSENGER], None), (stripped, Device.CAMERA)]
    assert asked == [*solarized, *messenger] * 2
    measure_unusual(scenes, [model], Table(tmp_path / "table", {}, "c"), kinds=kinds)
    assert len(asked) == 10
    names = [label(scene, kind) for scene in scenes for kind in kinds]
    cases = Cases(table.rows("P6", dict.fromkeys(ways_of("fixed_model"), model.key), names))
    counts = {(row["group"], row["estimator"]): row["accepted"] for row in unusual_rows(cases)}
    assert {counts["", way] for way in ways_of("fixed_model")} == {2}
    assert counts[UnusualKind.SOLARIZED.value, "fixed_model"] == 2
    assert counts[UnusualKind.MESSENGER.value, "fixed_model"] == 0
