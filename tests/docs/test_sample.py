import re
import runpy

import numpy as np
import pytest

from crfnet.luts.files import WRITERS

#: A number that is not a part of a word, such as the digest of a model.
NUMBER = re.compile(r"(?<![\w.+-])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.])")

#: The id of a CLF file is a digest of its table.
DIGEST = re.compile(r"crfnet-[0-9a-f]{32}")

#: Processors and versions of onnxruntime differ in the last digits of the weights, by 1e-5, and inverse responses are
#: up to 8 times as steep; relative above 1.
SAME = 2e-4

LARGEST_PICTURE = 1_200_000


@pytest.fixture(scope="module")
def script(root):
    """The names of a script of docs/, by its name."""
    return lambda name: runpy.run_path(str(root / "docs" / f"{name}.py"))


def text_and_numbers(path):
    """The text of a file without its numbers, and the numbers."""
    text = DIGEST.sub("crfnet-digest", path.read_text(encoding="utf-8"))
    return NUMBER.sub("#", text), np.array(NUMBER.findall(text), dtype=np.float64)


def test_the_sample_is_what_the_command_writes(root, script, tmp_path):
    """Byte for byte the config; LUTs and figures but for the last digits; the picture by its size."""
    image = pytest.importorskip("matplotlib.image")
    sample = root / "docs" / "sample"
    script("make_sample")["make_sample"](tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {path.name for path in sample.iterdir()} - {"README.md"}
    assert (tmp_path / "config.ocio").read_bytes() == (sample / "config.ocio").read_bytes()
    for name in (*(f"plate{suffix}" for suffix in WRITERS), "plate.json"):
        (text, numbers), (sample_text, sample_numbers) = map(text_and_numbers, (tmp_path / name, sample / name))
        assert text == sample_text
        np.testing.assert_allclose(numbers, sample_numbers, rtol=SAME, atol=SAME)
    assert image.imread(tmp_path / "plate_sheet.png").shape == image.imread(sample / "plate_sheet.png").shape


def test_the_picture_is_drawn(root, script, tmp_path):
    pytest.importorskip("matplotlib")
    script("make_picture")["draw_picture"](tmp_path / "picture.png")
    sizes = [(folder / "picture.png").stat().st_size for folder in (tmp_path, root / "docs")]
    assert all(20_000 < size < LARGEST_PICTURE for size in sizes)


def test_the_defocus_keeps_flat_light_and_spreads_a_point_over_its_disk(script):
    blurred = script("make_picture")["disk_blurred"]
    np.testing.assert_allclose(blurred(np.full((5, 6, 3), 0.3), 2.0), 0.3)
    point = np.zeros((9, 9, 1))
    point[4, 4] = 1
    spread = blurred(point, 2.0)[..., 0]
    assert spread.sum() == pytest.approx(1)
    assert spread[4, 4] == spread[4, 5] > spread[4, 6] > spread[6, 6] == 0
