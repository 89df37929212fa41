"""What several tests of ocio/ need."""

import pytest


@pytest.fixture
def out(tmp_path):
    """An empty folder for output, beside the input in `tmp_path`."""
    (tmp_path / "out").mkdir()
    return tmp_path / "out"
