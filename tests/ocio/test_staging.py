import os
from pathlib import Path

import pytest

from crfnet.errors import PlateError
from crfnet.staging import STALE_SECONDS, staged_files


def content(folder):
    return {path.name: path.read_text() for path in folder.iterdir()}


def test_files_take_their_names_together(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    with staged_files(tmp_path) as staged:
        (staged / "a.txt").write_text("new")
        (staged / "b.txt").write_text("new")
        assert (tmp_path / "a.txt").read_text() == "old"
    assert content(tmp_path) == {"a.txt": "new", "b.txt": "new"}


def write(folder, names, *, problem=None):
    with staged_files(folder) as staged:
        for name in names:
            (staged / name).write_text("new")
        if problem:
            raise problem(f"{staged / names[-1]}: no room")


def test_a_failed_block_leaves_the_folder_as_it_was(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(ZeroDivisionError):
        write(tmp_path, ["a.txt"], problem=ZeroDivisionError)
    assert content(tmp_path) == {"a.txt": "old"}


def test_errors_name_the_final_file(tmp_path):
    with pytest.raises(PlateError) as caught:
        write(tmp_path, ["a.txt"], problem=PlateError)
    assert str(caught.value) == f"{tmp_path / 'a.txt'}: no room"


@pytest.mark.parametrize("locked", ["a.txt", "b.txt", "c.txt"])
def test_a_name_that_cannot_be_taken_leaves_the_folder_as_it_was(tmp_path, monkeypatch, locked):
    for name in ("a.txt", "c.txt"):
        (tmp_path / name).write_text("old")
    rename = Path.rename

    def refuse(path, target):
        if Path(target) == tmp_path / locked:
            raise PermissionError(1, "Operation not permitted")
        return rename(path, target)

    monkeypatch.setattr(Path, "rename", refuse)
    with pytest.raises(PlateError, match=rf"{locked}.*not permitted"):
        write(tmp_path, ["a.txt", "b.txt", "c.txt"])
    assert content(tmp_path) == {"a.txt": "old", "c.txt": "old"}


@pytest.mark.parametrize("is_done", [False, True])
@pytest.mark.parametrize("number", range(1, 6))
def test_an_interruption_at_any_moment_leaves_the_folder_as_it_was(tmp_path, monkeypatch, number, is_done):
    """At the move of every file, before it is done and after."""
    for name in ("a.txt", "c.txt"):
        (tmp_path / name).write_text("old")
    rename, calls = Path.rename, []

    def interrupt(path, target):
        calls.append(path)
        if len(calls) == number and is_done:
            rename(path, target)
        if len(calls) == number:
            raise KeyboardInterrupt
        return rename(path, target)

    monkeypatch.setattr(Path, "rename", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write(tmp_path, ["a.txt", "b.txt", "c.txt"])
    assert len(calls) == number
    assert content(tmp_path) == {"a.txt": "old", "c.txt": "old"}


def left_by_a_killed_run(folder, files):
    """Make a temporary folder with earlier files, old enough to be removed."""
    temporary = folder / ".crfnet-killed"
    (temporary / "earlier").mkdir(parents=True)
    for name, text in files.items():
        (temporary / "earlier" / name).write_text(text)
    then = temporary.stat().st_mtime - STALE_SECONDS - 1
    os.utime(temporary, (then, then))
    return temporary


def test_earlier_files_in_old_temporary_folders_go_back_where_there_is_none(tmp_path):
    left_by_a_killed_run(tmp_path, {"a.txt": "old", "b.txt": "old"})
    (tmp_path / "b.txt").write_text("new")
    with staged_files(tmp_path):
        pass
    assert content(tmp_path) == {"a.txt": "old", "b.txt": "new"}


def test_an_earlier_file_that_cannot_go_back_stays_where_it_is(tmp_path, monkeypatch):
    temporary = left_by_a_killed_run(tmp_path, {"a.txt": "old"})

    def refuse(path, target):
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(Path, "rename", refuse)
    with staged_files(tmp_path):
        pass
    assert content(temporary / "earlier") == {"a.txt": "old"}


def test_old_temporary_folders_are_removed_and_recent_ones_are_not(tmp_path):
    old, recent = tmp_path / ".crfnet-old", tmp_path / ".crfnet-recent"
    for folder in (old, recent):
        folder.mkdir()
        (folder / "file").write_text("left behind")
    then = old.stat().st_mtime - STALE_SECONDS - 1
    os.utime(old, (then, then))
    with staged_files(tmp_path):
        pass
    assert sorted(path.name for path in tmp_path.iterdir()) == [".crfnet-recent"]


def test_files_that_another_process_writes_meanwhile_are_kept(tmp_path):
    def write_beside():
        with staged_files(tmp_path, overwrite=False) as staged:
            (staged / "a.txt").write_text("new")
            (staged / "b.txt").write_text("new")
            (tmp_path / "b.txt").write_text("theirs")

    with pytest.raises(PlateError, match=r"b\.txt: was written by another process meanwhile"):
        write_beside()
    assert content(tmp_path) == {"b.txt": "theirs"}
