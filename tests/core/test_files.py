import os
import stat
from contextlib import suppress

import pytest

from crfnet.errors import LutError
from crfnet_core.errors import CRFNetError
from crfnet_core.files import LONGEST_NAME, atomic_write, cut_to_bytes
from crfnet_core.staging import staged_files
from tests.helpers.refusals import refused


def test_a_file_takes_its_name_when_it_is_whole(tmp_path):
    with atomic_write(tmp_path / "plate.cube") as temporary:
        assert (temporary.parent.parent, temporary.name) == (tmp_path, "plate.cube")
        temporary.write_text("whole")
        assert not (tmp_path / "plate.cube").exists()
    assert (tmp_path / "plate.cube").read_text() == "whole"
    assert [path.name for path in tmp_path.iterdir()] == ["plate.cube"]


def test_a_failure_leaves_nothing_behind(tmp_path):
    with pytest.raises(UnicodeEncodeError), atomic_write(tmp_path / "plate.cube") as temporary:
        temporary.write_text("half \u20ac", encoding="ascii")
    assert list(tmp_path.iterdir()) == []


def test_a_file_of_an_open_set_gets_its_name_with_the_others_and_one_that_fails_is_removed(tmp_path):
    with staged_files(tmp_path) as staged:
        with atomic_write(staged / "a") as temporary:
            assert temporary == staged / "a"
        with suppress(ZeroDivisionError), atomic_write(staged / "b"):
            raise ZeroDivisionError
        assert [path.name for path in staged.glob("[!.]*")] == ["a"]
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_an_existing_file_is_replaced_only_when_asked(tmp_path):
    target = tmp_path / "plate.cube"
    target.write_text("old")
    with refused(LutError, "exists"), atomic_write(target, error=LutError):
        pass
    assert target.read_text() == "old"
    with atomic_write(target, overwrite=True) as temporary:
        temporary.write_text("new")
    assert target.read_text() == "new"


@pytest.mark.parametrize("name", [".", "", "../folder"])
def test_a_folder_is_not_a_target(tmp_path, monkeypatch, name):
    (tmp_path / "folder").mkdir()
    monkeypatch.chdir(tmp_path / "folder")
    with refused(CRFNetError, "is_folder"), atomic_write(name):
        pass


@pytest.mark.skipif(os.name == "nt", reason="needs POSIX permissions")
def test_the_mask_of_permissions_holds_and_is_left_alone(tmp_path, monkeypatch):
    """It belongs to the process: while it is another, files of other threads have wrong permissions."""
    earlier = os.umask(0o027)
    try:
        monkeypatch.setattr(os, "umask", lambda mask: pytest.fail("the mask was changed"))
        with atomic_write(tmp_path / "plate.cube"):
            pass
    finally:
        monkeypatch.undo()
        os.umask(earlier)
    assert stat.S_IMODE((tmp_path / "plate.cube").stat().st_mode) == 0o640


@pytest.mark.parametrize("character", ["a", "\U0001f4f7"])
def test_the_longest_names_are_written(tmp_path, character):
    ending = ".cube"
    name = cut_to_bytes(character * LONGEST_NAME, LONGEST_NAME - len(ending)) + ending
    with atomic_write(tmp_path / name) as temporary:
        assert temporary.suffix == ending
        temporary.write_text("whole")
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_a_name_that_is_too_long_is_refused(tmp_path):
    with refused(LutError, "not_written"), atomic_write(tmp_path / ("a" * 300), error=LutError):
        pass
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "most", "expected"),
    [("plate", 5, "plate"), ("plate", 4, "plat"), ("\u00e9\u00e9", 3, "\u00e9"), ("a\udcffb", 9, "ab"), ("a", -1, "")],
)
def test_names_are_cut_between_characters(name, most, expected):
    assert cut_to_bytes(name, most) == expected
