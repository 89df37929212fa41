"""The plate of a file: its names, and the names of its frames."""

from pathlib import Path

import pytest

from .conftest import plate_from_file

SHOTS = Path("/shots")


@pytest.mark.parametrize(
    ("file", "name", "numbered"),
    [
        ("shot.0001.png", "shot", ("shot.", 4, ".png")),
        ("shot_1001.jpg", "shot", ("shot_", 4, ".jpg")),
        ("shot7.tif", "shot", ("shot", 1, ".tif")),
        ("sh010_v2.0099_main.png", "sh010_v2_main", ("sh010_v2.", 4, "_main.png")),
        ("0042.dpx", "Beach", ("", 4, ".dpx")),
        ("beach.png", "beach", None),
    ],
)
def test_the_last_number_of_a_sequences_file_is_the_frame_number(file, name, numbered):
    plate = plate_from_file(SHOTS / file, is_sequence=True, name="Beach.001")
    assert (plate.name, plate.file, plate.numbered) == (name, SHOTS / file, numbered)
    assert plate_from_file(SHOTS / "IMG_1234.jpg").numbered is None
