import errno
import os
import signal
import stat
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import pytest

from crfnet_core.errors import CRFNetError, PhotoError
from crfnet_core.staging import remove_abandoned, staged_files
from tests.helpers.refusals import refusal_of, refused


def content(folder):
    return {path.name: path.read_text() for path in folder.iterdir()}


def test_files_take_their_names_together(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    with staged_files(tmp_path) as staged:
        (staged / "a.txt").write_text("new")
        (staged / "b.txt").write_text("new")
        assert (tmp_path / "a.txt").read_text() == "old"
    assert content(tmp_path) == {"a.txt": "new", "b.txt": "new"}


def write(folder, names):
    with staged_files(folder) as staged:
        for name in names:
            (staged / name).write_text("new")


def test_names_of_temporary_files_are_refused_and_not_left_out(tmp_path):
    assert refusal_of(CRFNetError, write, tmp_path, ["a.txt", ".crfnet-b.txt"]).code == "name_reserved"
    assert not content(tmp_path)


def test_errors_keep_their_class_code_and_facts_and_name_the_final_file(tmp_path):
    inner = CRFNetError("exists")

    def fail():
        with staged_files(tmp_path) as staged:
            inner.facts = {"path": staged / "b.txt"}
            raise PhotoError("too_small", path=staged / "a.txt", width=64, first=inner, text=f"{staged}/c: no")

    with pytest.raises(PhotoError) as caught:
        fail()
    assert caught.value.code == "too_small"
    assert caught.value.facts == {"path": tmp_path / "a.txt", "width": 64, "first": inner, "text": f"{tmp_path}/c: no"}
    assert inner.facts == {"path": tmp_path / "b.txt"}


def test_a_disk_that_takes_no_more_names_keeps_no_temporary_folder(tmp_path, monkeypatch):
    def refuse(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(OSError, match="space"):
        write(tmp_path, ["a.txt"])
    assert not [*tmp_path.iterdir()]


@pytest.mark.skipif(os.name == "nt", reason="needs POSIX permissions")
def test_nobody_else_may_enter_the_temporary_folder(tmp_path):
    with staged_files(tmp_path) as staged:
        assert stat.S_IMODE(staged.stat().st_mode) == 0o700


@pytest.mark.skipif(sys.platform == "win32", reason="needs fsync of folders")
@pytest.mark.parametrize("number", range(4))
def test_what_is_not_on_the_disk_is_not_there(tmp_path, monkeypatch, number):
    """Two files, the temporary folder, the folder."""
    (tmp_path / "a.txt").write_text("old")
    real, calls = os.fsync, []

    def fail(descriptor):
        calls.append(descriptor)
        if len(calls) == number + 1:
            raise OSError(errno.EIO, "Input/output error")
        real(descriptor)

    monkeypatch.setattr(os, "fsync", fail)
    assert refusal_of(CRFNetError, write, tmp_path, ["a.txt", "b.txt"]).code == "not_written"
    assert content(tmp_path) == {"a.txt": "old"}


@pytest.mark.parametrize("is_done", [False, True])
@pytest.mark.parametrize("number", range(1, 6))
def test_an_interruption_at_any_moment_leaves_the_folder_as_it_was(tmp_path, monkeypatch, number, is_done):
    """At the move of every file, before it is done and after."""
    for name in ("a.txt", "c.txt"):
        (tmp_path / name).write_text("old")
    replace, calls = Path.replace, []

    def interrupt(path, target):
        calls.append(path)
        if len(calls) == number and is_done:
            replace(path, target)
        if len(calls) == number:
            raise KeyboardInterrupt
        return replace(path, target)

    monkeypatch.setattr(Path, "replace", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write(tmp_path, ["a.txt", "b.txt", "c.txt"])
    assert len(calls) >= number
    assert content(tmp_path) == {"a.txt": "old", "c.txt": "old"}


def left_by_a_killed_run(folder, earlier, staged=""):
    """Make a temporary folder of a set of three with earlier and new files, which no process has locked."""
    temporary = folder / ".crfnet-killed"
    (temporary / ".crfnet-earlier-3").mkdir(parents=True)
    (temporary / ".crfnet-lock").touch()
    for name in earlier:
        (temporary / ".crfnet-earlier-3" / name).write_text("old")
    for name in staged:
        (temporary / name).write_text("new")


@pytest.mark.parametrize(
    ("earlier", "staged", "there", "expected"),
    [
        ("ab", "", "b", {"a": "old", "b": "new"}),  # earlier files go back where there is none
        ("a", "ab", "c", {"a": "new", "b": "new", "c": "new"}),  # a set that has a name gets the others
        ("", "abc", "", {}),  # else the same command writes it again, and would refuse files that are there
    ],
)
def test_a_set_of_a_killed_run_is_completed_or_taken_back(tmp_path, earlier, staged, there, expected):
    left_by_a_killed_run(tmp_path, earlier, staged)
    for name in there:
        (tmp_path / name).write_text("new")
    remove_abandoned(tmp_path)
    assert content(tmp_path) == expected


@pytest.mark.parametrize("is_own", [False, True])
def test_an_earlier_file_that_cannot_go_back_stays_where_it_is(tmp_path, monkeypatch, is_own):
    """Of a killed run, and of one that finds its folder closed after it has moved the file away."""
    if is_own:
        (tmp_path / "a.txt").write_text("old")
    else:
        left_by_a_killed_run(tmp_path, ["a.txt"])
    replace = Path.replace

    def refuse(path, target):
        if Path(target).parent == tmp_path:
            raise PermissionError(1, "Operation not permitted")
        replace(path, target)

    monkeypatch.setattr(Path, "replace", refuse)
    with suppress(CRFNetError):
        write(tmp_path, ["a.txt", "b.txt"] if is_own else [])
    (earlier,) = tmp_path.glob(".crfnet-*/.crfnet-earlier-*")
    assert content(earlier) == {"a.txt": "old"}


@pytest.fixture
def secret(tmp_path):
    """A folder elsewhere, with a file that somebody else would like to have."""
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "key").write_text("secret")
    return tmp_path / "elsewhere"


def test_only_folders_without_content_or_with_our_locked_file_are_taken_for_ours(tmp_path):
    for name in (".crfnet-killed", ".crfnet-presets"):
        (tmp_path / name).mkdir()
    (tmp_path / ".crfnet-presets" / "mine").write_text("mine")
    remove_abandoned(tmp_path)
    assert content(tmp_path / ".crfnet-presets") == {"mine": "mine"}
    assert not (tmp_path / ".crfnet-killed").exists()


@pytest.mark.skipif(os.name == "nt", reason="needs links")
@pytest.mark.parametrize("name", [".crfnet-link", ".crfnet-killed/.crfnet-earlier-1"])
def test_nothing_of_others_is_taken_for_the_folder_of_a_killed_run(tmp_path, secret, monkeypatch, name):
    """Neither a link nor another user's folder: in a shared folder it could take away our files from elsewhere."""
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).symlink_to(secret)
    user = os.geteuid()
    monkeypatch.setattr(os, "geteuid", lambda: user + 1)
    remove_abandoned(tmp_path)
    assert content(secret) == {"key": "secret"}


@pytest.mark.skipif(os.name == "nt", reason="needs links")
def test_a_link_in_a_folder_of_ours_is_not_followed(tmp_path, secret):
    """An archive that somebody delivers may hold a temporary folder, which becomes the user's own when unpacked."""
    left_by_a_killed_run(tmp_path, "a", "b")
    (tmp_path / ".crfnet-killed" / ".crfnet-earlier-1").symlink_to(secret)
    (tmp_path / "key").write_text("mine")
    remove_abandoned(tmp_path)
    assert content(secret) == {"key": "secret"}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "b", "elsewhere", "key"]


@pytest.mark.skipif(os.name == "nt", reason="needs links")
def test_a_folder_that_others_have_put_in_the_place_of_the_temporary_one_is_left_alone(tmp_path, secret):
    (tmp_path / "out").mkdir()

    def exchange():
        with staged_files(tmp_path / "out") as staged:
            staged.rename(tmp_path / "ours")
            staged.symlink_to(secret)

    assert refusal_of(CRFNetError, exchange).code == "not_written"
    assert content(secret) == {"key": "secret"}
    assert [path.is_symlink() for path in (tmp_path / "out").iterdir()] == [True]


STAGE = """
import os, pathlib, sys
from crfnet_core.staging import staged_files
with staged_files(pathlib.Path(sys.argv[1])) as staged:
    (staged / "file").write_text("half")
    print(flush=True)
    sys.stdin.read()
"""


def test_temporary_folders_of_killed_runs_are_removed_and_those_of_others_are_not(tmp_path):
    """Whatever their age: the clocks of two computers differ."""
    with subprocess.Popen(
        [sys.executable, "-c", STAGE, tmp_path], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        process.stdout.readline()
        (temporary,) = tmp_path.iterdir()
        os.utime(temporary, (0, 0))
        write(tmp_path, ["a.txt"])
        assert (temporary / "file").exists()
        process.send_signal(signal.SIGKILL if os.name != "nt" else signal.SIGTERM)
    remove_abandoned.cache_clear()
    write(tmp_path, ["b.txt"])
    assert content(tmp_path) == {"a.txt": "new", "b.txt": "new"}


def test_a_folder_that_is_just_made_is_not_taken_for_abandoned(tmp_path):
    """Several frames are written at a time, and each write looks for the remains of killed runs."""

    def write_often(name):
        for number in range(100):
            remove_abandoned.__wrapped__(tmp_path)
            write(tmp_path, [f"{name}{number}"])

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(write_often, "abcd"))
    assert len(content(tmp_path)) == 400


@pytest.mark.parametrize("moment", ["while they are written", "at the last moment"])
def test_files_that_another_process_writes_meanwhile_are_kept(tmp_path, monkeypatch, moment):
    def write_beside():
        with staged_files(tmp_path, overwrite=False) as staged:
            (staged / "a.txt").write_text("new")
            (staged / "b.txt").write_text("new")
            if moment == "while they are written":
                (tmp_path / "b.txt").write_text("theirs")

    fsync = os.fsync
    if moment == "at the last moment":  # the flushed temporary folder is the last before the names
        monkeypatch.setattr(os, "fsync", lambda number: (fsync(number), (tmp_path / "b.txt").write_text("theirs")))
    with refused(CRFNetError, "written_meanwhile", path=tmp_path / "b.txt"):
        write_beside()
    assert content(tmp_path) == {"b.txt": "theirs"}
