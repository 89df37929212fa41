"""The plate of a file: its names, and the pattern of its frames."""

from pathlib import Path

import pytest

from .conftest import plate_from_file

SHOTS = Path("/shots")


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
    plate = plate_from_file(SHOTS / file, is_sequence=True, name="Beach.001")
    assert plate.numbered is not None
    assert (plate.name, plate.file, plate.pattern) == (name, SHOTS / placeholder, pattern)


@pytest.mark.parametrize(("file", "is_sequence"), [("IMG_1234.jpg", False), ("beach.png", True)])
def test_a_file_that_is_no_frame_stands_for_itself(file, is_sequence):
    plate = plate_from_file(SHOTS / file, is_sequence=is_sequence)
    assert plate.numbered is None
    assert (plate.name, plate.file, plate.pattern) == (Path(file).stem, SHOTS / file, file)
