import numpy as np
import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")

from training.realism.classifier import separation, single_aucs


def sets(shift, *, seed=0):
    """Two sets of 90 photographs in 15 groups, of 60 features; those of a group are alike."""
    rng = np.random.default_rng(seed)
    groups = np.repeat(np.arange(15), 6)
    made = [rng.standard_normal((15, 60))[groups] + rng.standard_normal((90, 60)) for _ in range(2)]
    made[1][:, :5] += shift
    return *made, groups, groups


def test_alike_sets_are_not_told_apart():
    areas = [separation(*sets(0, seed=seed)).auc for seed in range(6)]
    assert np.mean(areas) == pytest.approx(0.5, abs=0.08)


def test_different_sets_are_told_apart_and_the_interval_is_around_it():
    found = separation(*sets(2.5))
    assert found.auc > 0.9
    assert found.interval[0] < found.auc < found.interval[1] <= 1
    assert str(found).startswith(f"{found.auc:.2f} (")


def test_features_are_judged_one_by_one_and_equal_ones_separate_nothing():
    first, second = np.array([[1.0, 0, 3], [2, 0, 2]]), np.array([[3.0, 0, 1], [4, 0, 2.5]])
    np.testing.assert_allclose(single_aucs(first, second), [1, 0.5, 0.25])
