from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")
pytest.importorskip("PIL", reason="training needs the train extra")

pytest.importorskip("matplotlib", reason="training needs the train extra")

from crfnet_core.photograph.metadata import Device, FileMetadata
from crfnet_core.posterior import Verdict
from training.evaluation.measure.unusual import (
    WRITTEN,
    accepted_by_kind,
    accepted_overall,
    measure_unusual,
    unusual_photographs,
    unusual_report,
)
from training.evaluation.measure.verdict_files import VerdictFile
from training.evaluation.report.real.content import BodySummary, RealReport, TrustedWrongly
from training.evaluation.report.unusual import Accepted, unusual_section
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


def test_a_picture_does_not_depend_on_which_others_are_asked_for(scene):
    kinds = (UnusualKind.LOG_FOOTAGE, UnusualKind.AGX)
    (_, _), (_, with_other) = unusual_photographs([File(scene)], kinds)
    ((_, alone),) = unusual_photographs([File(scene)], kinds[1:])
    np.testing.assert_array_equal(alone.pixels, with_other.pixels)


def test_good_and_usable_are_accepted():
    log, agx = UnusualKind.LOG_FOOTAGE, UnusualKind.AGX
    verdicts = [(log, Verdict.GOOD), (agx, Verdict.DO_NOT_TRUST), (log, Verdict.USABLE), (log, Verdict.DO_NOT_TRUST)]
    by_kind = accepted_by_kind(verdicts)
    assert by_kind == {log: Accepted(3, 2), agx: Accepted(1, 0)}
    assert by_kind[log].fraction == pytest.approx(2 / 3)
    assert accepted_overall(by_kind) == Accepted(4, 2)
    assert accepted_overall({}).fraction == 0


def test_p6_asks_once_as_of_files_that_name_no_camera_and_again_without_what_programs_write(
    scene, fixed_model, tmp_path, monkeypatch
):
    asked = []

    def estimate(photo, *, network, **options):
        asked.append((photo.metadata, options))
        return SimpleNamespace(verdict=Verdict.GOOD if "solarised" in str(photo.path) else Verdict.DO_NOT_TRUST)

    monkeypatch.setattr("training.evaluation.measure.unusual.estimate_response", estimate)
    kinds, scenes = (UnusualKind.SOLARIZED, UnusualKind.MESSENGER), [File(scene, "a"), File(scene, "b")]
    file = VerdictFile.opened(tmp_path / "p6.json", {"seed": 1})
    measure_unusual(scenes, {"m": fixed_model}, {"m": file}, kinds=kinds)
    stripped = FileMetadata(file_format="PNG")
    untold, told = {"device": None}, {"device": Device.CAMERA}
    solarized = [(stripped, untold), (stripped, told)]
    messenger = [(WRITTEN[UnusualKind.MESSENGER], untold), (stripped, untold), (stripped, told)]
    assert asked == [*solarized, *messenger] * 2
    again = VerdictFile.opened(tmp_path / "p6.json", {"seed": 1})
    assert again.verdicts == file.verdicts
    ways = ("solarised or inverted", "solarised or inverted, camera told")
    ways += ("messenger", "messenger, stripped", "messenger, camera told")
    assert list(again.verdicts) == [f"{name}, {way}" for name in "ab" for way in ways]
    measure_unusual(scenes, {"m": fixed_model}, {"m": again}, kinds=kinds)
    assert len(asked) == 10
    report = unusual_report(scenes, again, kinds)
    assert report.overall == report.stripped == report.told == Accepted(4, 2)
    assert VerdictFile.opened(tmp_path / "p6.json", {"seed": 2}).verdicts == {}


def test_the_section_stands_beside_the_refused_photographs_of_cameras(scene):
    kind = UnusualKind.AGX
    file = VerdictFile(
        Path("p6.json"),
        {},
        {
            "a, rendering, AgX": Verdict.GOOD,
            "b, rendering, AgX": Verdict.DO_NOT_TRUST,
            "a, rendering, AgX, stripped": Verdict.GOOD,
            "b, rendering, AgX, stripped": Verdict.GOOD,
            "a, rendering, AgX, camera told": Verdict.GOOD,
            "b, rendering, AgX, camera told": Verdict.USABLE,
        },
    )
    report = {"m": unusual_report([File(scene, "a"), File(scene, "b")], file, (kind,))}
    summary = BodySummary(3, 8, {}, ())
    accepted = {"m": 8, "m, EXIF lost": 4, "m, EXIF lost, kind told": 7, "m, metadata ignored": 6}
    trusted = {name: TrustedWrongly(count, 0, 0, 0) for name, count in accepted.items()}
    empty = ("kinds", "origins", "origins_of_everything", "weights", "weights_of_everything", "pooled")
    parts = {name: {} for name in empty}
    real = RealReport(
        trusted=summary,
        everything=None,
        trusted_wrongly=trusted,
        trusted_wrongly_of_everything=trusted,
        bodies=(),
        photographs=(),
        **parts,
    )
    text = "\n".join(unusual_section(report, {"both": real}))
    assert "| rendering, AgX | 50 % (1 of 2) |" in text
    assert "| **all kinds** | 50 % (1 of 2) |" in text
    assert "| all kinds, without metadata | 100 % (2 of 2) |" in text
    assert "| all kinds, without metadata, a camera told | 100 % (2 of 2) |" in text
    assert "| m | 0 % (0 of 8) | 0 % (0 of 8) |" in text
    assert "| m, EXIF lost | 50 % (4 of 8) | 50 % (4 of 8) |" in text
    assert "| m, EXIF lost, kind told | 12 % (1 of 8) | 12 % (1 of 8) |" in text
    assert "| m, metadata ignored | 25 % (2 of 8) | 25 % (2 of 8) |" in text
    assert "refused" not in "\n".join(unusual_section(report, None))
