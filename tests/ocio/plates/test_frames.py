import sys

import numpy as np
import pytest

from crfnet.errors import PlateError
from crfnet.plates.frame_numbers import MAX_FRAMES, format_frames, parse_frames
from crfnet.plates.frame_pattern import FramePattern
from crfnet.plates.frames import FrameSequence, find_frames, sample_frames
from tests.helpers.refusals import refusal_of, refused


def touch(folder, *names):
    for name in names:
        (folder / name).touch()


def names(sequence):
    return [path.name for path in sequence.paths]


@pytest.mark.parametrize(
    ("pattern", "number", "name"),
    [
        *(("plate.%04d.png", 7, "plate.0007.png"), ("plate.%d.png", 7, "plate.7.png")),
        *(("plate.%04d.png", -3, "plate.-003.png"), ("plate.#.exr", 12345, "plate.12345.exr")),
        *(("plate_@@@@@.exr", 7, "plate_00007.exr"), ("a@2x.%03d.png", 1, "a@2x.001.png")),
        *(("shot.$F4.png", 7, "shot.0007.png"), ("shot.$F.png", 7, "shot.7.png")),
        *(("shot_v2-%04d.png", 7, "shot_v2-0007.png"), ("take1-2####.png", 7, "take1-20007.png")),
        ("a$b.[1-3].####.png", 7, "a$b.[1-3].0007.png"),
    ],
)
def test_a_pattern_names_the_file_of_a_frame(pattern, number, name):
    assert FramePattern.parse(pattern).path(number).name == name


@pytest.mark.parametrize("name", ["plate.png", "plate.%s.png", "plate.%4d.png", "100%.png", "a[1].png", "$FF.png"])
def test_a_name_without_a_placeholder_is_not_a_pattern(name):
    assert FramePattern.parse(name) is None


@pytest.mark.parametrize("name", ["a.%04d.%04d.png", "a.##.##.png", "@a@.png", "$F.$F4.png"])
def test_several_placeholders_are_refused(name):
    with refused(PlateError, "several_placeholders", count=2):
        FramePattern.parse(name)


@pytest.mark.parametrize("name", ["plate.png", "a@2x.png"])
def test_a_single_file_has_no_frame_numbers_whatever_its_name(tmp_path, name):
    touch(tmp_path, name, "a52x.png")
    assert find_frames(str(tmp_path / name)) == FrameSequence((tmp_path / name,), (), ())


@pytest.mark.parametrize("pattern", ["p.%04d.png", "p.####.png", "p.#.png", "p.@@@@.png"])
def test_a_sequence_is_sorted_by_number_and_reports_gaps(tmp_path, pattern):
    touch(tmp_path, "p.0010.png", "p.0009.png", "p.0012.png", "p.0015.png")
    sequence = find_frames(tmp_path / pattern)
    assert names(sequence) == ["p.0009.png", "p.0010.png", "p.0012.png", "p.0015.png"]
    assert (sequence.numbers, sequence.missing) == ((9, 10, 12, 15), (11, 13, 14))


def test_other_files_are_left_alone(tmp_path):
    touch(tmp_path, "p.0001.png", "p.001.png", "p.00002.png", "p.0003.jpg", "q.0004.png", ".p.0005.png", "p.0006.png~")
    touch(tmp_path, ".p.0007.abcdefgh.png", "p.٠٠٠٨.png", "pX0009.png")
    (tmp_path / "p.0010.png").mkdir()
    assert find_frames(tmp_path / "p.%04d.png").numbers == (1,)


def test_only_the_chosen_frames_are_found(tmp_path):
    touch(tmp_path, *(f"p.{number:04d}.png" for number in (1, 2, 3, 5, 8)))
    sequence = find_frames(tmp_path / "p.####.png", "2-6,20")
    assert (sequence.numbers, sequence.missing) == ((2, 3, 5), (4, 6, 20))
    assert find_frames(tmp_path / "p.####.png", [8, 1, 1]).numbers == (1, 8)


@pytest.mark.parametrize(
    ("files", "numbers"),
    [
        *((["p.0009.png", "p.0010.png", "p.0012.png"], (9, 10, 12)), (["0001.jpg", "0002.jpg"], (1, 2))),
        (["p.98.png", "p.99.png", "p.100.png"], (98, 99, 100)),
        (["p.-002.png", "p.-001.png", "p.0000.png"], (-2, -1, 0)),
        (["shot-0001.png", "shot-0002.png"], (1, 2)),
        (["a@2x.%d 1-3#.01.png", "a@2x.%d 1-3#.02.png"], (1, 2)),
    ],
)
def test_a_folder_with_one_sequence_is_that_sequence(tmp_path, files, numbers):
    touch(tmp_path, *files, "notes.txt", "plate01.json", ".hidden.0001.png", ".hidden.0002.png")
    sequence = find_frames(tmp_path)
    assert (sequence.numbers, names(sequence)) == (numbers, files)
    assert find_frames(tmp_path, [numbers[0]]).paths == sequence.paths[:1]


def test_a_folder_with_several_sequences_lists_them(tmp_path):
    touch(tmp_path, *(f"{shot}.{number:04d}.png" for shot in "ab" for number in (1, 2)))
    with refused(PlateError, "several_sequences", patterns="a.%04d.png, b.%04d.png"):
        find_frames(tmp_path)


def test_the_add_on_needs_no_fileseq(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "fileseq", None)
    touch(tmp_path, "p.0001.png", "p.0003.png")
    sequence = find_frames(tmp_path / "p.%04d.png")
    assert (sequence.numbers, format_frames(sequence.missing)) == ((1, 3), "2")


@pytest.mark.parametrize(
    ("frames", "numbers"),
    [
        *(("1001-1003", (1001, 1002, 1003)), ("1-10x3", (1, 4, 7, 10)), ("1,5,9", (1, 5, 9)), ("007", (7,))),
        *(("3,1-4", (1, 2, 3, 4)), ("-3--1", (-3, -2, -1)), ("5-1", (1, 2, 3, 4, 5)), ("1-6y3", (2, 3, 5, 6))),
        *(((3, 1, 3), (1, 3)), (np.array([4, 2]), (2, 4))),
    ],
)
def test_a_specification_stands_for_ascending_numbers(frames, numbers):
    assert parse_frames(frames) == numbers


@pytest.mark.parametrize("frames", ["", "a", "1-", "1-2-3", "1;2", "1,,2", "1 2", "1.5", "٣", "1-5x0", "1-2x0.5"])
def test_a_malformed_specification_is_refused(frames):
    assert refusal_of(PlateError, parse_frames, frames).code == "bad_frames"


@pytest.mark.parametrize("frames", ["0-999999999", "1-5000000"])
def test_an_endless_range_is_refused_at_once(frames):
    with refused(PlateError, "too_many_frames", most=MAX_FRAMES):
        parse_frames(frames)


def test_frames_that_are_too_far_apart_are_refused(tmp_path):
    touch(tmp_path, "p.1.png", "p.20261121.png")
    assert refusal_of(PlateError, find_frames, tmp_path / "p.%d.png").code == "frames_far_apart"
    assert find_frames(tmp_path / "p.%d.png", "1").numbers == (1,)


@pytest.mark.parametrize(
    ("name", "frames", "code"),
    [
        *((name, None, "no_such_plate") for name in ("q.png", "x" * 300 + ".png", "p.*.png")),
        *(("empty", None, "folder_without_sequence"), ("p.0001.png", "1-3", "single_file")),
        *(("q.%04d.png", None, "no_such_frames"), ("p.%04d.png", "7-9", "no_such_frames")),
        *(("absent/p.%04d.png", None, "cannot_list"), ("/dev/null", None, "not_a_file")),
    ],
)
def test_what_cannot_be_found_is_named(tmp_path, name, frames, code):
    touch(tmp_path, "p.0001.png", "p.0002.png")
    (tmp_path / "empty").mkdir()
    touch(tmp_path / "empty", "readme.txt", "p.0001.png", ".p.0002.png")
    assert refusal_of(PlateError, find_frames, tmp_path / name, frames).code == code


@pytest.mark.parametrize(
    ("total", "count", "positions"),
    [
        (100, 8, [0, 14, 28, 42, 57, 71, 85, 99]),
        *((8, 8, [0, 1, 2, 3, 4, 5, 6, 7]), (5, 8, [0, 1, 2, 3, 4]), (9, 3, [0, 4, 8]), (9, 1, [0]), (1, 8, [0])),
    ],
)
def test_samples_are_evenly_spread(tmp_path, total, count, positions):
    paths = tuple(tmp_path / f"{number}.png" for number in range(total))
    assert sample_frames(FrameSequence(paths), count) == tuple(paths[position] for position in positions)


@pytest.mark.parametrize(
    ("numbers", "text"),
    [
        *(([], ""), ([1, 2, 3, 7, 9, 10], "1-3, 7, 9-10"), ([1, 3, 5, 7, 9], "1, 3, 5, 7, 9")),
        ([1, 3, 5, 7, 9, 11], "1, 3, 5, 7, 9, …"),
    ],
)
def test_numbers_are_shown_as_ranges(numbers, text):
    assert format_frames(numbers) == text
