"""The plate of a file: its names, and the pattern of its frames."""

from pathlib import Path

import pytest

from blender_addon.work.job import Plate


def plate_of(name, *, is_sequence=True):
    return Plate.from_file(
        Path("/shots") / name,
        is_sequence=is_sequence,
        datablock_name="Beach.001",
        uid=7,
        color_space="sRGB",
        folder=Path("/shots"),
    )


@pytest.mark.parametrize(
    ("file", "name", "placeholder", "pattern"),
    [
        ("shot.0001.png", "shot", "shot.%04d.png", "shot.*.png"),
        ("shot_1001.jpg", "shot", "shot_%04d.jpg", "shot_*.jpg"),
        ("shot7.tif", "shot", "shot%01d.tif", "shot*.tif"),
        ("sh010_v2.0099_main.png", "sh010_v2_main", "sh010_v2.%04d_main.png", "sh010_v2.*_main.png"),
        ("0042.dpx", "Beach", "%04d.dpx", "*.dpx"),
    ],
)
def test_the_last_number_of_a_sequences_file_is_the_frame_number(file, name, placeholder, pattern):
    plate = plate_of(file)
    assert plate.is_sequence
    assert plate.name == name
    assert plate.file == Path("/shots") / placeholder
    assert plate.pattern == pattern


@pytest.mark.parametrize(("file", "is_sequence"), [("IMG_1234.jpg", False), ("beach.png", True)])
def test_a_file_that_is_no_frame_stands_for_itself(file, is_sequence):
    plate = plate_of(file, is_sequence=is_sequence)
    assert not plate.is_sequence
    assert plate.name == Path(file).stem
    assert plate.file == Path("/shots") / file
    assert plate.pattern == file
