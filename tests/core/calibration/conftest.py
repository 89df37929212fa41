"""Stacks of known responses, made once."""

import pytest

from tests.helpers.stacks import StackOptions, light_of, make_stack


@pytest.fixture(scope="session")
def light(root):
    """The light of a scene with range, float32 (H, W, 3): every second pixel, so that the tests are quick."""
    return light_of(root / "tests" / "data" / "lights" / "interior.exr")[::2, ::2]


@pytest.fixture
def stack(tmp_path, light, true_response):
    """Write a stack of the bundled photograph's response: stack(frames=5, quality=0, Make="Canon") -> its paths."""

    def write(*, response=None, folder=tmp_path, header=None, **options):
        return make_stack(folder, light, response or true_response, StackOptions(**options), **(header or {}))

    return write
