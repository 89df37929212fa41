from dataclasses import replace

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="training needs the train extra")
pytest.importorskip("onnxscript", reason="training needs the train extra")

from crfnet_core.statistics.windows import filled_bins
from training.crfnet2017 import pack as packing
from training.crfnet2017.pack import area_scaled, read_pack, write_scenes
from training.crfnet2017.windows import LinearWindows, WindowStream, code_table, draw_windows, render_windows


def test_scenes_are_averaged_by_whole_factors():
    pixels = np.arange(800 * 802 * 3, dtype=np.float32).reshape(800, 802, 3)
    scaled = area_scaled(pixels)
    assert scaled.shape == (400, 401, 3)
    assert scaled[0, 0].tolist() == pixels[:2, :2].mean(axis=(0, 1)).tolist()
    assert area_scaled(pixels[:789]).shape == (789, 802, 3)


def test_a_pack_is_read_as_it_was_written(tmp_path, monkeypatch):
    monkeypatch.setattr(packing, "SHARD_SAMPLES", 700)
    scenes = [(str(n), np.full((10, 10 + n, 3), n, np.float16)) for n in range(4)]
    write_scenes(scenes, tmp_path, "train")
    np.savez(tmp_path / "curves.npz", curves=np.zeros((1, 1024)), exposures=np.ones(1))
    assert len(list(tmp_path.glob("train_*.npy"))) == 3
    for found, (_, pixels) in zip(read_pack(tmp_path, "train").scenes, scenes, strict=True):
        assert np.array_equal(found, pixels)


def test_an_absent_pack_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match="no pack of the split train"):
        read_pack(tmp_path, "train")


def test_windows_meet_the_papers_rule(pack):
    windows = render_windows(draw_windows(pack, 6, np.random.default_rng(1)), torch.from_numpy(pack.curves))
    assert windows.shape == (6, 3, 227, 227)
    assert min(filled_bins(window.numpy()) for window in windows) >= 220


def test_dull_scenes_give_no_windows(pack):
    dull = np.full((300, 300, 3), 0.5, np.float16)
    mixed = replace(pack, scenes=(dull, pack.scenes[0]))
    irradiance = draw_windows(mixed, 8, np.random.default_rng(1)).irradiance
    assert all(window.unique().numel() > 1 for window in irradiance)


def test_a_photograph_gives_several_windows_if_asked(pack):
    batch = draw_windows(pack, 6, np.random.default_rng(1), per_photograph=3)
    assert batch.classes[:3].unique().numel() == 1
    assert batch.exposures[3:].unique().numel() == 1


def test_the_device_makes_the_codes_of_the_host(pack):
    batch = draw_windows(pack, 2, np.random.default_rng(2))
    codes = (render_windows(batch, torch.from_numpy(pack.curves)) * 255).permute(0, 2, 3, 1).round().byte().numpy()
    for n, curve in enumerate(batch.classes):
        table = code_table(pack.curves[curve], float(batch.exposures[n]))
        assert np.mean(codes[n] != table[batch.irradiance[n].numpy().view(np.uint16)]) < 1e-3


def test_a_known_irradiance_gets_a_known_code():
    irradiance = torch.full((1, 227, 227, 3), 0.5, dtype=torch.float16)
    square = torch.linspace(0, 1, 1024)[None] ** 2
    windows = render_windows(LinearWindows(irradiance, torch.tensor([0]), torch.tensor([1.2])), square)
    assert windows.unique().tolist() == pytest.approx([92 / 255])


def test_the_windows_of_a_step_do_not_depend_on_the_start(pack):
    def stream(steps, rank=0):
        return [batch.irradiance for batch in WindowStream(pack, batch=2, steps=steps, seed=3, rank=rank)]

    assert torch.equal(stream(range(4))[3], stream(range(3, 4))[0])
    assert not torch.equal(stream(range(3, 4))[0], stream(range(3, 4), rank=1)[0])
