import numpy as np
import pytest

from tests.helpers.images import read_image
from tests.helpers.linear_pictures import SWATCH, chart, manifest, ramp, swatch_means, write_dng, write_float
from training.data.import_scenes import import_scene, main
from training.data.linear_files import linear_scene

COLORS = [[0.8, 0.2, 0.1], [0.1, 0.6, 0.2], [0.15, 0.2, 0.7], [0.6, 0.5, 0.1], [0.1, 0.5, 0.5], [0.25, 0.2, 0.15]]


@pytest.mark.parametrize(
    ("values", "options"),
    [
        *((ramp(1.0), {"pattern": "RGGB"}), (ramp(1.0), {"camera": "two", "pattern": "BGGR"})),
        (ramp(1.0), {"pattern": "GRBG"}),
        (ramp(1.0), {"light": (1.5, 1.0, 0.4)}),  # warm, and balanced as the camera did
        *((COLORS, {"camera": "one"}), (COLORS, {"camera": "two"})),
    ],
)
def test_raw_grays_and_colors_are_the_scene_in_rec709(tmp_path, out, values, options):
    scene = chart(values)
    import_scene(write_dng(tmp_path / "raw.dng", scene, **options), out)
    means = swatch_means(read_image(out / "raw.exr"), SWATCH)
    np.testing.assert_allclose(means, swatch_means(scene, SWATCH), rtol=0.01)


def test_double_the_light_is_double_the_value_and_white_clips_at_1(tmp_path, out):
    values = []
    for top in (0.45, 0.9, 1.8):  # LibRaw would by itself take 0.9 for white
        import_scene(write_dng(tmp_path / f"top{top}.dng", chart(ramp(top))), out)
        values.append(swatch_means(read_image(out / f"top{top}.exr"), SWATCH))
    np.testing.assert_allclose(values[0][0, 0], 0.45, rtol=0.01)
    dark = 5 / 65535  # LibRaw rounds down a few times
    np.testing.assert_allclose(values[1], 2 * values[0], rtol=0.005, atol=dark)
    np.testing.assert_array_equal(values[2][0, 0], [1, 1, 1])
    np.testing.assert_allclose(values[2], np.minimum(1, 4 * values[0]), rtol=0.005, atol=2 * dark)


def test_raw_is_averaged_in_linear_light_to_a_shorter_side_of_454(tmp_path, out, capsys):
    scene = chart(ramp(1.0), rows=30, columns=40)  # 960 x 1280
    path = write_dng(tmp_path / "large.dng", scene)
    assert main([str(path), "--out", str(out), "--licence", "CC0"]) == 0
    means = swatch_means(read_image(out / "large.exr"), SWATCH // 2)
    np.testing.assert_allclose(means, swatch_means(scene, SWATCH), rtol=0.01)
    notes = "sensor white = 1; area-averaged 2x2 from 1280x960"
    (row,) = manifest(out)
    assert [*row.values()] == ["large.exr", "photograph", "640", "480", "imported: large.dng", "CC0", notes]
    assert capsys.readouterr().out.endswith(f"large.exr: photograph, 640 x 480, {notes}\n")


def test_exr_is_scaled_by_a_power_of_two_without_negative_values(tmp_path):
    light = np.full((240, 300, 3), 20.0)
    light[0, 0] = [-5, np.nan, 3]
    light[1, 1] = 1e8
    pixels, notes = linear_scene(write_float(tmp_path / "a.exr", light))
    assert pixels.dtype == np.float16
    assert pixels[100, 100].tolist() == [0.15625] * 3  # 20 / 2**7
    assert pixels[0, 0].tolist() == [0, 0, 3 / 128]
    assert pixels[1, 1].tolist() == [65000 // 32 * 32] * 3  # the steps of half floats there
    assert notes == ["scale=2^-7", "4.6e-06 negative samples set to 0", "1 px clipped at 65000 after scale"]


def test_a_panorama_keeps_the_rows_around_its_horizon(tmp_path, out):
    light = np.ones((300, 600, 3)) * np.arange(1, 301)[:, None, None]
    row = import_scene(write_float(tmp_path / "sky.hdr", light), out, kind="panorama")
    assert (row["kind"], row["width"], row["height"]) == ("panorama band", "600", "240")
    assert read_image(out / "sky.exr")[0, 0, 0] == pytest.approx(31 / 1024, rel=0.01)
