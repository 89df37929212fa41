"""Where the files of real photographs come from."""

import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")

from training.data.real.file_origin import Editing, editing, is_scaled


@pytest.mark.parametrize(
    ("software", "make", "use", "expected"),
    [
        ("Adobe Photoshop CS6 (Windows)", "Canon", "yes", Editing.EDITED),
        ("", "Canon", "caution: edited/developed by software, jitter>0.2", Editing.EDITED),
        ("Microsoft Windows Photo Viewer 6.1", "SONY", "yes", Editing.NOT_NAMED),
        ("", "", "yes", Editing.UNKNOWN),
    ],
)
def test_an_editor_is_known_by_its_name(software, make, use, expected):
    assert editing(software, make=make, use=use) is expected


def test_a_photograph_without_1600_pixels_is_scaled():
    sizes = ("1280x853", "1600x1200", "2848x4288", "853x1280")
    assert [is_scaled(size) for size in sizes] == [True, False, False, True]
