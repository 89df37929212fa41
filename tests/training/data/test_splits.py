import numpy as np
import pytest

from crfnet_core.errors import CRFNetError
from crfnet_core.response.curve import UNIFORM
from training.data import splits
from training.data.splits import SPLITS, check_splits, curve_groups, read_scenes, split_scenes

#: The published scenes of each split.
PUBLISHED = SPLITS["scenes"]


def write_list(folder, *names):
    folder.mkdir(exist_ok=True)
    rows = [f"{name},{'photograph' if name.startswith('mine') else 'panorama band'}" for name in names]
    (folder / "manifest.csv").write_text("\n".join(["file,kind", *rows, ""]))


def test_no_group_is_wider_than_its_diameter_and_groups_are_numbered_as_they_appear():
    curves = UNIFORM ** np.linspace(0.3, 1.5, 60)[:, None]
    groups = np.array(curve_groups(curves))
    for group in np.unique(groups):
        members = curves[groups == group]
        assert np.linalg.norm(members[:, None] - members, axis=2).max() <= 1.0
    assert list(dict.fromkeys(groups)) == list(range(groups.max() + 1))
    assert groups.max() < 30


def test_the_splits_of_the_repository_are_whole():
    groups, held_out = np.array(SPLITS["curve_groups"]), SPLITS["held_out_curves"]
    rest = np.setdiff1d(np.arange(201), held_out)
    assert (len(groups), groups.max() + 1, len(held_out)) == (201, 48, 40)
    assert not set(groups[held_out]) & set(groups[rest])
    assert {split: len(names) for split, names in PUBLISHED.items()} == {"test": 20, "validation": 12, "train": 94}
    assert len({name for names in PUBLISHED.values() for name in names}) == 126


def test_imported_scenes_only_train_and_move_no_other(tmp_path):
    published = [name for names in PUBLISHED.values() for name in names]
    write_list(tmp_path, "mine.exr", *sorted(published))
    assert split_scenes(tmp_path, with_imported=False) == {
        split: [(name, True) for name in names] for split, names in PUBLISHED.items()
    }
    assert split_scenes(tmp_path)["train"][94:] == [("mine.exr", False)]


def test_a_split_without_scenes_says_so(tmp_path):
    write_list(tmp_path, "mine.exr")
    with pytest.raises(CRFNetError, match="none is left for the split validation"):
        read_scenes(tmp_path, "validation")


def test_data_split_otherwise_is_refused(tmp_path, monkeypatch):
    write_list(tmp_path / "linear", *PUBLISHED["train"], *PUBLISHED["validation"], *PUBLISHED["test"][1:])
    monkeypatch.setattr(splits, "read_dorf", lambda _: UNIFORM ** np.array([[0.3], [0.9]]))
    with pytest.raises(CRFNetError, match=r"scenes and curve_groups differ from splits\.json"):
        check_splits(tmp_path)
