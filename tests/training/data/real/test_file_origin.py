"""Where the files of real photographs come from."""

import pytest

pytest.importorskip("scipy.io", reason="training needs the train extra")

from training.data.real.file_origin import is_edited


@pytest.mark.parametrize(
    ("software", "use", "expected"),
    [
        ("Adobe Photoshop CS6 (Windows)", "yes", True),
        ("", "caution: edited/developed by software, jitter>0.2", True),
        ("Microsoft Windows Photo Viewer 6.1", "yes", False),
        ("", "yes", False),
    ],
)
def test_an_editor_is_known_by_its_name(software, use, expected):
    assert is_edited(software, use) is expected
