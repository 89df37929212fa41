"""What several tests of ocio/ need."""

import shutil

import pytest

from tests.helpers.images import read_image
from tests.helpers.stacks import StackOptions, light_of, make_stack


@pytest.fixture
def out(tmp_path):
    """An empty folder for output, beside the input in `tmp_path`."""
    (tmp_path / "out").mkdir()
    return tmp_path / "out"


@pytest.fixture(scope="session")
def look(crfnet, plate, fixed_model, tmp_path_factory):
    """The output folder of `crfnet estimate` on the bundled photograph, float EXR."""
    folder = tmp_path_factory.mktemp("look")
    assert crfnet("estimate", plate, "--out", folder, "--model", fixed_model, "--depth", "float").printed
    return folder


@pytest.fixture(scope="session")
def linear(crfnet, look, plate, tmp_path_factory):
    """The pixels that `crfnet linearize` makes of the bundled photograph."""
    path = tmp_path_factory.mktemp("linear") / "linear.exr"
    assert crfnet("linearize", plate, "--lut", look / "plate.spi1d", "--out", path, "--depth", "float").code == 0
    return read_image(path)


@pytest.fixture(scope="session")
def stack(root, true_response, tmp_path_factory):
    """A stack of 6 frames of a small picture, in PNG."""
    light = light_of(root / "tests" / "data" / "lights" / "interior.exr")[::2, ::2]
    header = {"Make": "Canon", "Model": "Canon EOS 20D", "Exif__PhotographicSensitivity": 100}
    return make_stack(
        tmp_path_factory.mktemp("stack"), light, true_response, StackOptions(frames=6, quality=0), **header
    )


@pytest.fixture
def estimate(crfnet, fixed_model, tmp_path):
    """Run `crfnet estimate` with the fixed model into tmp_path/out, without a sheet."""

    def run(*arguments):
        return crfnet("estimate", *arguments, "--out", tmp_path / "out", "--model", fixed_model, "--no-sheet")

    return run


@pytest.fixture
def frames(plate, tmp_path):
    """A folder with frames 1, 2, 3 and 5 of a plate: shot.0001.jpg and so on."""
    for number in (1, 2, 3, 5):
        shutil.copy(plate, tmp_path / f"shot.{number:04d}.jpg")
    return tmp_path


@pytest.fixture
def photographs(plate, tmp_path):
    """A folder with three photographs, one of them in a subfolder, and a file that is none."""
    folder = tmp_path / "photographs"
    (folder / "day 2").mkdir(parents=True)
    for name in ("a.jpg", "b.JPG", "day 2/a.jpg"):
        shutil.copy(plate, folder / name)
    (folder / "notes.txt").write_text("no photograph")
    return folder
