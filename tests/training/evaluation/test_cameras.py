"""Errors of measured cameras on other stacks, on responses that are known."""

from types import SimpleNamespace

import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")

from crfnet_core import ResponseCurve
from crfnet_core.library import CameraSettings
from crfnet_core.response.metrics import estimation_error, shape_error
from training.data.real.stacks import Stack
from training.evaluation.cameras import Setting, of_another_stack


def stack(gamma, path):
    settings = CameraSettings("NIKON CORPORATION", "NIKON D90")
    return Stack(path / f"{gamma}.csv", settings, ResponseCurve.gamma(gamma), 0.5, 9, "A", "")


@pytest.fixture
def setting(tmp_path):
    """Two stacks of gamma 2.0 and 2.2, and a photograph of the first whose estimate is gamma 1.8."""
    stacks = (stack(2.0, tmp_path), stack(2.2, tmp_path))
    photograph = SimpleNamespace(stack=stacks[0], own=SimpleNamespace(curve=ResponseCurve.gamma(1.8)))
    return Setting("NIKON D90", "NIKON D90", stacks, (photograph,))


def test_each_stack_is_measured_by_the_other_and_estimates_by_their_own(setting):
    measured, estimated = of_another_stack(setting, setting.stacks)
    one, other = (stack.curve for stack in setting.stacks)
    assert measured[0] == pytest.approx(estimation_error(one, other))
    assert measured[1] == pytest.approx(shape_error(one, other), rel=0.01)
    assert estimated[0] == pytest.approx(estimation_error(one, ResponseCurve.gamma(1.8)))


def test_a_setting_of_one_stack_is_left_out(setting):
    assert of_another_stack(setting, setting.stacks[:1]) is not None
    alone = Setting("a", "a", setting.stacks[:1], setting.photographs)
    assert of_another_stack(alone, alone.stacks) is None
