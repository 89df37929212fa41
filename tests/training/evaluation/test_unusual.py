import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")
pytest.importorskip("PIL", reason="training needs the train extra")

from crfnet_core.network import Verdict
from training.evaluation.measure.unusual import Accepted, accepted_by_kind, accepted_overall, unusual_photographs
from training.synthesis.unusual import UnusualKind


class File:
    """A scene file that counts how often it is read."""

    def __init__(self, scene):
        self.scene, self.read_count = scene, 0

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
    assert by_kind[log].share == pytest.approx(2 / 3)
    assert accepted_overall(by_kind) == Accepted(4, 2)
    assert accepted_overall({}).share == 0
