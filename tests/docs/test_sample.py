"""The pictures and the sample in docs/ are what the code makes."""

import importlib.util
import re

import numpy as np
import pytest

from crfnet.luts.files import WRITERS

#: A number that is no part of a word, such as the digest of a model.
NUMBER = re.compile(r"(?<![\w.+-])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.])")

#: The id of a CLF file is a digest of its table.
DIGEST = re.compile(r"crfnet-[0-9a-f]{32}")

#: Processors and versions of onnxruntime differ in the last digits of the weights, by 1e-5, and inverse responses are
#: up to 8 times as steep; relative above 1.
SAME = 2e-4

LARGEST_PICTURE = 1_200_000


def load(root, name):
    spec = importlib.util.spec_from_file_location(name, root / "docs" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def make_sample(root):
    return load(root, "make_sample")


@pytest.fixture(scope="module")
def written(make_sample, tmp_path_factory):
    folder = tmp_path_factory.mktemp("sample")
    make_sample.make_sample(folder)
    return folder


@pytest.fixture(scope="module")
def sample(root):
    return root / "docs" / "sample"


def text_and_numbers(path):
    """The text of a file without its numbers, and the numbers."""
    text = DIGEST.sub("crfnet-digest", path.read_text(encoding="utf-8"))
    return NUMBER.sub("#", text), np.array(NUMBER.findall(text), dtype=np.float64)


def test_the_sample_holds_what_the_command_writes(sample, written):
    assert {path.name for path in written.iterdir()} == {path.name for path in sample.iterdir()} - {"README.md"}


def test_the_config_is_byte_for_byte_the_sample(sample, written):
    assert (written / "config.ocio").read_bytes() == (sample / "config.ocio").read_bytes()


@pytest.mark.parametrize("name", [*(f"plate{suffix}" for suffix in WRITERS), "plate.json"])
def test_luts_and_figures_are_the_sample_but_for_the_last_digits(sample, written, name):
    text, numbers = text_and_numbers(written / name)
    sample_text, sample_numbers = text_and_numbers(sample / name)
    assert text == sample_text
    np.testing.assert_allclose(numbers, sample_numbers, rtol=SAME, atol=SAME)


def test_the_sheet_is_a_picture_of_half_the_size(sample, written):
    image = pytest.importorskip("matplotlib.image")
    assert image.imread(written / "plate_sheet.png").shape == image.imread(sample / "plate_sheet.png").shape
    assert (sample / "plate_sheet.png").stat().st_size < LARGEST_PICTURE


def test_halving_takes_the_mean_of_four_pixels(make_sample):
    picture = np.arange(16.0).reshape(4, 4, 1)
    np.testing.assert_array_equal(make_sample.halved(picture)[..., 0], [[2.5, 4.5], [10.5, 12.5]])


def test_the_picture_of_the_readme_is_drawn(root, tmp_path):
    load(root, "make_picture").draw_picture(tmp_path / "picture.png")
    assert 100_000 < (tmp_path / "picture.png").stat().st_size < LARGEST_PICTURE
    assert (root / "docs" / "picture.png").stat().st_size < LARGEST_PICTURE


def test_the_defocus_keeps_flat_light_and_spreads_a_point_over_its_disk(root):
    blurred = load(root, "make_picture").disk_blurred
    np.testing.assert_allclose(blurred(np.full((5, 6, 3), 0.3), 2.0), 0.3)
    point = np.zeros((9, 9, 1))
    point[4, 4] = 1
    spread = blurred(point, 2.0)[..., 0]
    assert spread.sum() == pytest.approx(1)
    assert spread[4, 4] == spread[4, 5] > spread[4, 6] > spread[6, 6] == 0
