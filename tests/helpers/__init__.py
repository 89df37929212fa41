"""What the tests of several folders share, apart from the fixtures in `tests/conftest.py`."""
