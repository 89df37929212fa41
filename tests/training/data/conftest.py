"""What the tests of imported scenes share."""

import pytest


@pytest.fixture
def out(tmp_path):
    """The folder of the scenes, which the import makes."""
    return tmp_path / "data" / "linear"
