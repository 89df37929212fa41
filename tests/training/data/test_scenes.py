import pytest

from crfnet_core.errors import CRFNetError
from training.data.scenes import read_scenes, split_scenes


@pytest.fixture
def listed(tmp_path):
    lines = [f"pano{n:03d}.exr,panorama band" for n in range(100)] + [f"photo{n:02d}.exr,photograph" for n in range(12)]
    (tmp_path / "manifest.csv").write_text("file,kind\n" + "\n".join(lines) + "\n")
    return tmp_path


def test_splits_share_no_scene_and_lose_none(listed):
    splits = split_scenes(listed)
    names = [name for split in splits.values() for name, _ in split]
    assert len(names) == len(set(names)) == 112
    assert {split: len(scenes) for split, scenes in splits.items()} == {"test": 20, "validation": 12, "train": 80}
    assert sum(not is_panorama for _, is_panorama in splits["test"]) == 3


def test_imported_scenes_only_train_and_move_no_other(listed):
    before = split_scenes(listed)
    rows = (listed / "manifest.csv").read_text().splitlines()
    more = ["file,kind,source", *(f"{row},somewhere" for row in rows[1:]), "mine.exr,photograph,imported: mine.dng"]
    (listed / "manifest.csv").write_text("\n".join(more) + "\n")
    assert split_scenes(listed) == before | {"train": [*before["train"], ("mine.exr", False)]}
    assert split_scenes(listed, with_imported=False) == before


def test_a_split_without_scenes_says_so(tmp_path):
    (tmp_path / "manifest.csv").write_text("file,kind\none.exr,photograph\n")
    with pytest.raises(CRFNetError, match="none is left for the split validation"):
        read_scenes(tmp_path, "validation")
