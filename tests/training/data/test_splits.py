import json

import numpy as np
import pytest

from crfnet_core.errors import CRFNetError
from crfnet_core.response.curve import UNIFORM
from training.data import splits
from training.data.splits import SPLITS_FILE, curve_groups, held_out_curves


def powers(*exponents):
    return np.stack([UNIFORM**p for p in exponents])


def test_no_group_is_wider_than_its_diameter():
    curves = powers(*np.linspace(0.3, 1.5, 60))
    groups = curve_groups(curves)
    for group in np.unique(groups):
        members = curves[groups == group]
        assert np.linalg.norm(members[:, None] - members, axis=2).max() <= 1.0
    assert len(np.unique(groups)) < 30


def test_whole_groups_are_held_out():
    curves = powers(*np.linspace(0.3, 1.5, 60))
    groups, chosen = curve_groups(curves), held_out_curves(curves)
    rest = np.setdiff1d(np.arange(60), chosen)
    assert len(chosen) == 12
    assert not set(groups[chosen]) & set(groups[rest])


def test_the_splits_of_the_repository_are_whole():
    kept = json.loads(SPLITS_FILE.read_text())
    groups, held_out = np.array(kept["curve_groups"]), kept["held_out_curves"]
    rest = np.setdiff1d(np.arange(201), held_out)
    assert (len(groups), groups.max() + 1, len(held_out)) == (201, 48, 40)
    assert not set(groups[held_out]) & set(groups[rest])
    scenes = [name for split in kept["scenes"].values() for name in split]
    assert len(scenes) == len(set(scenes)) == 126
    assert len(kept["scenes"]["test"]) == 20


def test_data_split_otherwise_is_refused(monkeypatch, tmp_path):
    found = json.loads(SPLITS_FILE.read_text()) | {"held_out_curves": [1, 2]}
    monkeypatch.setattr(splits, "compute_splits", lambda _: found)
    with pytest.raises(CRFNetError, match=r"held_out_curves differ from splits\.json"):
        splits.checked_splits(tmp_path)
