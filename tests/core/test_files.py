import pytest

from crfnet_core.errors import CRFNetError, LutError
from crfnet_core.files import atomic_write


def test_a_file_takes_its_name_when_it_is_whole(tmp_path):
    with atomic_write(tmp_path / "plate.cube") as temporary:
        assert temporary.parent == tmp_path
        assert temporary.suffix == ".cube"
        temporary.write_text("whole")
        assert not (tmp_path / "plate.cube").exists()
    assert (tmp_path / "plate.cube").read_text() == "whole"
    assert [path.name for path in tmp_path.iterdir()] == ["plate.cube"]


def test_a_failure_leaves_nothing_behind(tmp_path):
    with pytest.raises(UnicodeEncodeError), atomic_write(tmp_path / "plate.cube") as temporary:
        temporary.write_text("half \u20ac", encoding="ascii")
    assert list(tmp_path.iterdir()) == []


def test_an_existing_file_is_replaced_only_when_asked(tmp_path):
    target = tmp_path / "plate.cube"
    target.write_text("old")
    with pytest.raises(LutError, match="exists already"), atomic_write(target, error=LutError):
        pass
    assert target.read_text() == "old"
    with atomic_write(target, overwrite=True) as temporary:
        temporary.write_text("new")
    assert target.read_text() == "new"


def test_the_folder_has_to_exist(tmp_path):
    with pytest.raises(CRFNetError, match="does not exist"), atomic_write(tmp_path / "no" / "plate.cube"):
        pass


def test_a_folder_is_no_target(tmp_path):
    with pytest.raises(CRFNetError, match="is a folder"), atomic_write(tmp_path):
        pass


def test_the_file_has_the_permissions_of_any_other(tmp_path):
    (tmp_path / "other").touch()
    with atomic_write(tmp_path / "plate.cube"):
        pass
    assert (tmp_path / "plate.cube").stat().st_mode == (tmp_path / "other").stat().st_mode
