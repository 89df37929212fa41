from types import SimpleNamespace

from crfnet_core.photograph.metadata import Device, FileMetadata
from crfnet_core.posterior import Verdict
from training.evaluation.measure.table import Table
from training.evaluation.measure.unusual import WAYS, WRITTEN, label, measure_unusual
from training.evaluation.report.cases import Cases
from training.evaluation.report.rows import unusual_rows
from training.synthesis.unusual import UnusualKind


def test_p6_asks_once_with_what_programs_write_without_it_and_with_a_camera_stated(scene, model, tmp_path, monkeypatch):
    asked, files = [], [SimpleNamespace(name=name, read=lambda: scene) for name in "ab"]

    def estimate(photo, *, network, options):
        asked.append((photo.metadata, options.device))
        return SimpleNamespace(verdict=Verdict.USABLE if "solarized" in str(photo.path) else Verdict.DO_NOT_TRUST)

    monkeypatch.setattr("training.evaluation.measure.unusual.estimate_response", estimate)
    table = Table(tmp_path / "table", {})
    measure_unusual(files, [model], table)
    stripped, expected = FileMetadata(file_format="PNG"), []
    for kind in UnusualKind:
        written = [(WRITTEN[kind], None)] if kind in WRITTEN else []
        expected += [(stripped, None), *written, (stripped, Device.CAMERA)]
    assert asked == expected * 2
    measure_unusual(files, [model], Table(tmp_path / "table", {}))
    assert len(asked) == len(expected) * 2
    names = [label(file, kind) for file in files for kind in UnusualKind]
    asked_as = [f"fixed_model{way}" for way in WAYS]
    cases = Cases(table.rows("P6", dict.fromkeys(asked_as, model.key), names))
    counts = {(row["group"], row["estimator"]): row["accepted"] for row in unusual_rows(cases)}
    assert {counts["", way] for way in asked_as} == {2}
    assert counts[UnusualKind.SOLARIZED.value, "fixed_model"] == 2
    assert counts[UnusualKind.MESSENGER.value, "fixed_model"] == 0
