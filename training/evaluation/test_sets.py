"""Test sets: scenes, responses, and the exposure s_crf that belongs to each response."""

import hashlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.stats import norm

from crfnet_core.response.curve import UNIFORM, ResponseCurve
from crfnet_core.response.emor import EmorBasis
from crfnet_core.response.transfer_functions import rec709_encode, srgb_encode
from crfnet_core.types import Float32Array, Float64Array
from training.data.curves import read_dorf
from training.data.linear_files import read_raw
from training.data.scenes import BAND, Scene, read_scene
from training.data.splits import SPLITS, check_splits, split_scenes
from training.synthesis.camera import TARGET_BRIGHTNESS, automatic_exposure, reference_luminance

#: Five of Blender's studio lights (CC0), as Blender 4.5 stores them; their panoramas and SHA-256 are in the README.md
#: there. Sunrise, sunset and night are left out, because the training data holds these panoramas.
LIGHTS_FOLDER = Path(__file__).parents[2] / "tests" / "data" / "lights"

#: Standard deviation, in stops, of the log-normal luminance that sets the exposures where there are no training
#: scenes: about as in the training scenes, each scaled to a geometric mean of 1.
REFERENCE_STOPS = 2.0

#: The kind of a camera's raw file.
RAW = "raw photograph"


@dataclass(frozen=True)
class SceneFile:
    """A scene on disk; `kind` is "panorama", "photograph" or `RAW`, and `is_light` marks a studio light of Blender."""

    name: str
    kind: str
    path: Path
    is_light: bool = False

    def read(self) -> Scene:
        """Return the scene."""
        if self.kind == RAW:
            light = np.divide(read_raw(self.path), 65535, dtype=np.float32)
            return Scene.scaled(self.name, light.astype(np.float16).astype(np.float32), False)
        return read_light(self.path) if self.is_light else read_scene(self.path, self.kind == "panorama")


@dataclass(frozen=True, eq=False)
class TestSet:
    """Scenes that no model was trained on, and responses."""

    __test__ = False  # no test class of pytest

    scenes: tuple[SceneFile, ...]
    curves: Float64Array  # float64 (N, 1024): true responses at 1024 uniform irradiances
    held_out: tuple[int, ...] = ()  # numbers of the responses that P2 holds out; empty without such a split
    data: Path | None = None  # the folder of the data; None for the bundled test set
    #: Raw photographs of high resolution, for the resolutions of the paper's Sec. 5.2.
    originals: tuple[SceneFile, ...] = ()

    @property
    def files(self) -> tuple[SceneFile, ...]:
        """Scenes and originals, as they are numbered."""
        return self.scenes + self.originals

    @cached_property
    def exposures(self) -> Float64Array:
        """s_crf of every response, shape (N,): it belongs to the response and not to the photograph."""
        luminance = log_normal_luminance() if self.data is None else training_luminance(self.data)
        return np.array([automatic_exposure(curve, luminance) for curve in self.curves])

    @property
    def digest(self) -> str:
        """A short hash of the scenes' names, the responses and the rule of exposure."""
        names = "\n".join([*(scene.name for scene in self.scenes), f"{TARGET_BRIGHTNESS:g}"])
        return hashlib.sha256(names.encode() + np.round(self.curves, 6).tobytes()).hexdigest()[:16]


def dorf_test_set(data: Path) -> TestSet:
    """Return the test scenes of the folder `data` and the responses of DoRF; CRFNetError as of `check_splits`."""
    check_splits(data)
    files = split_scenes(data / "linear", with_imported=False)["test"]
    scenes = tuple(
        SceneFile(Path(name).stem, "panorama" if is_panorama else "photograph", data / "linear" / name)
        for name, is_panorama in files
    )
    originals = tuple(SceneFile(path.stem, RAW, path) for path in sorted((data / "raw_pairs").glob("*.crw")))
    return TestSet(scenes, read_dorf(data), tuple(SPLITS["held_out_curves"]), data, originals)


def bundled_test_set() -> TestSet:
    """Return studio lights of Blender and responses made from formulas that come with the repository."""
    scenes = tuple(SceneFile(path.stem, "panorama", path, True) for path in sorted(LIGHTS_FOLDER.glob("*.exr")))
    return TestSet(scenes, formula_curves())


def read_light(path: Path) -> Scene:
    """Return the middle rows of a studio light, as of a panorama."""
    pixels = read_scene(path, is_panorama=True).pixels
    low, high = (round(fraction * len(pixels)) for fraction in BAND)
    return Scene.scaled(path.stem, pixels[low:high], is_panorama=True)


def formula_curves() -> Float64Array:
    """Return responses, shape (13, 1024): powers, logarithms, standards, an S-curve, and steps along EMoR."""
    basis, encoded = EmorBasis.load(), srgb_encode(UNIFORM)
    rows = [UNIFORM ** (1 / power) for power in (1.4, 1.8, 2.6)]
    rows += [np.log1p(factor * UNIFORM) for factor in (8, 60)]
    rows += [encoded, rec709_encode(UNIFORM), encoded**2 * (3 - 2 * encoded)]
    for weights in ([], [-4], [4], [0, 2], [-2, -1.5]):
        rows.append(basis.reconstruct(np.array(weights + [0.0] * (11 - len(weights)))))
    return np.stack([ResponseCurve.from_samples(row).brightness for row in rows])


def training_luminance(data: Path) -> Float32Array:
    """Return luminances of training scenes, but of no imported ones: they must not change the test photographs."""
    files = split_scenes(data / "linear", with_imported=False)["train"]
    return reference_luminance([read_scene(data / "linear" / name, is_panorama) for name, is_panorama in files])


def log_normal_luminance() -> Float32Array:
    """Return evenly spaced quantiles, float32 (4096,), of a log-normal luminance with a geometric mean of 1."""
    quantiles = norm.ppf((np.arange(4096) + 0.5) / 4096)
    return np.exp2(REFERENCE_STOPS * quantiles).astype(np.float32)
