import numpy as np
import pytest

pytest.importorskip("torch", reason="training needs the train extra")

from crfnet_core.statistics import LENGTH
from training.data.curves import CurveSource
from training.data.scenes import Scene
from training.realism.__main__ import subject_row
from training.realism.feature_names import feature_names
from training.realism.samples import ALL, CUES, SampleSet, simulated_samples
from training.synthesis.camera import reference_luminance
from training.synthesis.camera_draws import CameraShares, FrameKind

CURVES = CurveSource(np.linspace(0, 1, 1024)[None] ** 0.4, (), camera_fraction=0, plain_fraction=1)


def made_scenes(count, *, is_panorama=False):
    """Return scenes of smooth colored light with some noise."""
    rng, (y, x) = np.random.default_rng(5), np.mgrid[:300, :500] / 100
    light = np.exp(np.sin(3 * x) + np.cos(2 * y) + 0.3 * rng.standard_normal((300, 500)))
    pixels = (light[:, :, None] * [1.0, 0.8, 0.6]).astype(np.float32)
    return [Scene(str(number), pixels, is_panorama) for number in range(count)]


def test_every_feature_has_a_name():
    counts = np.ones((2, LENGTH), np.float32)
    samples = SampleSet.of(counts, [0, 1])
    assert len(feature_names()) == samples.features[ALL].shape[1]
    assert sum(samples.features[cue].shape[1] for cue in CUES) == samples.features[ALL].shape[1]


def test_simulated_photographs_come_evenly_from_the_scenes():
    scenes = made_scenes(2)
    shares = CameraShares.only(FrameKind.NATIVE)
    samples = simulated_samples(scenes, CURVES, shares, reference_luminance(scenes), count=4, seed=0)
    assert samples.groups.tolist() == [0, 1, 0, 1]
    assert np.isfinite(samples.features[ALL]).all()


def test_subjects_of_both_kinds_are_told_apart_by_every_cue():
    scenes = made_scenes(3) + made_scenes(4, is_panorama=True)
    line = subject_row(scenes, CURVES, reference_luminance(scenes), count=6, seed=0)
    areas = [float(cell.split()[0]) for cell in line.split("|")[3:-1]]
    assert len(areas) == len(CUES) + 1
    assert all(0 <= area <= 1 for area in areas)
