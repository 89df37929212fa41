import json
import os
import shutil
import sys
from pathlib import Path

import pytest

from crfnet.defaults import ESTIMATES
from crfnet.output_files import folded
from crfnet.pipeline import run
from tests.helpers.configs import loaded
from tests.helpers.folders import listed, tree
from tests.helpers.records import plates_in, records_in

QUICK = ("--each", "--no-sheet", "--no-linear", "--workers", "1")


def test_names_of_one_alias_or_rule_are_two_photographs(estimate, photographs, tmp_path):
    for name in ("a-b.jpg", "a_b.jpg", "a b.jpg", "a .jpg"):
        shutil.copy(photographs / "a.jpg", photographs / name)
    assert estimate(photographs, *QUICK).code == 0
    assert plates_in(tmp_path / "out") == ["a_", "a b", "a-b", "a", "a_b", "b"]
    assert loaded(tmp_path / "out" / "config.ocio").getColorSpace("crf_a_b").getName() == "CRF a_b"


@pytest.mark.parametrize("name", ["a.jpeg", "A.jpg"])
def test_two_of_one_name_get_files_of_their_own(estimate, photographs, tmp_path, name):
    shutil.copy(photographs / "a.jpg", photographs / name)
    if len(listed(photographs)) < 4:
        pytest.skip("this file system takes A and a for one name")
    for _ in range(2):
        assert estimate(photographs / "a.jpg", photographs / name, *QUICK).code == 0
        luts = {Path(record["photograph"]).name: record["lut"] for record in records_in(tmp_path / "out")}
        assert (luts["a.jpg"], luts[name].casefold()) == ("a.spi1d", "a_2.spi1d")
        assert sorted(map(str.casefold, plates_in(tmp_path / "out"))) == ["a", "a_2"]


def test_names_that_differ_in_case_or_in_the_form_of_an_accent_only_are_one():
    assert folded("PLA\u0308TE") == folded("pl\u00e4te") != folded("plate")


def test_a_photograph_that_is_given_twice_is_one(estimate, photographs, tmp_path, monkeypatch):
    """Also in a later run, and by a link to its folder."""
    (tmp_path / "link").symlink_to(photographs)
    monkeypatch.chdir(photographs)
    assert estimate("a.jpg", photographs / "a.jpg", "day 2/../a.jpg", tmp_path / "link" / "a.jpg", *QUICK).code == 0
    assert estimate(tmp_path / "link" / "a.jpg", *QUICK).code == 0
    assert [record["photograph"] for record in records_in(tmp_path / "out")] == ["a.jpg"]


def test_a_photograph_of_a_later_run_takes_no_files_of_another(estimate, photographs, tmp_path):
    assert estimate(photographs / "a.jpg", *QUICK).code == 0
    before = tree(tmp_path / "out")
    notes = estimate(photographs / "day 2", *QUICK).out
    assert "\nnote: no file rule leads to CRF a_2, CRF a: several plates " in notes
    assert tree(tmp_path / "out")["a.spi1d"] == before["a.spi1d"]
    assert [record["lut"] for record in records_in(tmp_path / "out")] == ["a.spi1d", "a_2.spi1d"]


def test_a_photograph_is_known_by_its_place_wherever_the_command_runs(crfnet, look, photographs, tmp_path, monkeypatch):
    def linearize(shot, *names):
        monkeypatch.chdir(tmp_path / shot)
        options = ("--each", "--workers", "1", "--lut", look / "plate.spi1d", "--out", "../out")
        assert crfnet("linearize", *names, *options).code == 0
        return len(list((tmp_path / "out").rglob("*.exr")))

    shutil.copytree(photographs, tmp_path / "b")
    photographs.rename(tmp_path / "a")
    assert linearize("a", "a.jpg", "b.JPG") == 2
    assert linearize("b", "a.jpg") == 3
    assert linearize("a", tmp_path / "a" / "a.jpg") == 3


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such names")
def test_names_that_are_no_text_fail_alone(estimate, photographs, tmp_path):
    for name in (b"\xff.jpg", b"\xfe.jpg", b"a\xff.jpg"):
        shutil.copy(photographs / "a.jpg", photographs / os.fsdecode(name))
    for names in ([photographs], [photographs], sorted(photographs.glob("*.[jJ]*"))):
        assert estimate(*names, *QUICK).refusal == "photographs_failed"
        errors = {record["photograph"]: record["error"] for record in records_in(tmp_path / "out")}
        assert [bool(errors[name]) for name in sorted(errors)] == [True, True, False, True, False, False]
        assert errors[f"{photographs}/\\udcff.jpg"].startswith(f"{photographs}/?.jpg: ")
    assert plates_in(tmp_path / "out") == ["a", "b"]


@pytest.mark.parametrize("separator", ["\u2028", "\u2029", "\x85"])
def test_a_name_with_a_separator_of_lines_is_one_line(estimate, photographs, tmp_path, separator):
    shutil.copy(photographs / "a.jpg", photographs / f"c{separator}d.jpg")
    assert estimate(photographs, *QUICK).code == 0
    before = tree(tmp_path / "out")
    assert estimate(photographs, *QUICK).code == 0
    assert tree(tmp_path / "out") == before


def test_a_line_that_was_cut_within_a_character_is_left_out(estimate, photographs, tmp_path):
    shutil.copy(photographs / "a.jpg", photographs / "\u5199.jpg")
    assert estimate(photographs, *QUICK).code == 0
    manifest = tmp_path / "out" / ESTIMATES
    whole = manifest.read_bytes()
    manifest.write_bytes(whole[: whole.rindex("\u5199".encode()) + 1])
    assert estimate(photographs, *QUICK).code == 0
    assert sorted(manifest.read_bytes().split(b"\n")) == sorted(whole.split(b"\n"))


def test_files_that_are_gone_with_their_photographs_are_in_no_config(estimate, photographs, tmp_path):
    assert estimate(photographs, *QUICK).code == 0
    for folder in (photographs, tmp_path / "out"):
        shutil.rmtree(folder / "day 2")
    for path in (photographs / "b.JPG", *(tmp_path / "out").glob("b.*")):
        path.unlink()
    assert estimate(photographs, *QUICK).printed
    assert plates_in(tmp_path / "out") == ["a"]
    assert not (tmp_path / "out" / "day 2").exists()


def test_the_output_folder_and_hidden_files_are_no_photographs(crfnet, fixed_model, photographs):
    (photographs / "._a.jpg").write_bytes(b"what macOS keeps beside a file")
    (photographs / ".thumbnails").mkdir()
    shutil.copy(photographs / "a.jpg", photographs / ".thumbnails")
    out = photographs / "look"
    arguments = ("estimate", photographs, "--each", "--no-linear", "--workers", "1", "--model", fixed_model)
    for _ in range(2):
        assert crfnet(*arguments, "--out", out).printed
        assert len(records_in(out)) == 3
    assert "a_sheet.png" in listed(out)


def test_photographs_in_the_output_folder_itself_are_searched_and_sheets_are_not(crfnet, fixed_model, photographs):
    shutil.copy(photographs / "a.jpg", photographs / "my_sheet.png")
    arguments = ("estimate", photographs, "--out", photographs, "--model", fixed_model, "--each", "--workers", "1")
    for _ in range(2):
        assert crfnet(*arguments, "--no-linear").printed
    names = [Path(record["photograph"]).name for record in records_in(photographs)]
    assert names == ["a.jpg", "b.JPG", "a.jpg", "my_sheet.png"]


@pytest.mark.parametrize("folder", ["", "out"])
def test_a_folder_without_other_photographs_is_refused(crfnet, fixed_model, photographs, tmp_path, out, folder):
    done = crfnet("estimate", tmp_path / folder, "--out", photographs, "--model", fixed_model, *QUICK)
    assert done.refusal == "empty_folder"


@pytest.fixture
def locked(monkeypatch):
    """The names of folders that nobody may read."""
    names, scandir = set(), os.scandir

    def refuse(path="."):
        if not isinstance(path, int) and Path(path).name in names:
            raise PermissionError(13, "Permission denied", str(path))
        return scandir(path)

    monkeypatch.setattr(os, "scandir", refuse)
    return names


def test_a_subfolder_that_cannot_be_read_is_named_and_tried_again(estimate, photographs, tmp_path, locked):
    locked.add("day 2")
    shutil.copy(photographs / "a.jpg", photographs / "day 2.jpg")
    assert estimate(photographs, *QUICK).refusal == "photographs_failed"
    *others, error = [record["error"] for record in records_in(tmp_path / "out")]
    assert (others, error.startswith(f"{photographs / 'day 2'}: ")) == ([""] * 3, True)
    locked.clear()
    done = estimate(photographs, *QUICK, "--json")
    assert (done.code, [record["error"] for record in json.loads(done.out)["estimates"]]) == (0, [""] * 4)


def test_a_folder_that_cannot_be_read_is_refused(estimate, photographs, tmp_path, locked):
    locked.add("photographs")
    assert estimate(photographs, *QUICK).refusal == "unreadable"
    assert not (tmp_path / "out").exists()


def test_a_run_that_replaces_takes_no_file_that_another_has_written_meanwhile(
    estimate, photographs, tmp_path, out, monkeypatch
):
    (tmp_path / "others").mkdir()
    shutil.copy(photographs / "b.JPG", tmp_path / "others" / "a.jpg")
    plan_tasks = run.plan_tasks

    def planned(*arguments):
        tasks = plan_tasks(*arguments)
        monkeypatch.setattr(run, "plan_tasks", plan_tasks)
        assert estimate(photographs, *QUICK, "--overwrite").code == 0
        return tasks

    monkeypatch.setattr(run, "plan_tasks", planned)
    assert estimate(tmp_path / "others", *QUICK, "--overwrite").refusal == "photographs_failed"
    assert {record["photograph"]: record["error"] for record in records_in(out)}[str(photographs / "a.jpg")] == ""
    assert json.loads((out / "a.json").read_text())["photographs"][0]["name"] == "a.jpg"
    assert estimate(tmp_path / "others", *QUICK, "--overwrite").code == 0
    assert sorted(plates_in(out)) == ["a", "a_2", "b"]
