"""Measure a model: ``python -m training.evaluate --data DIR [--real] --out FILE.json``.

P0: every DoRF curve on every held-out scene, at one of five exposures; through the product's own `estimate_response`.
With --real: real camera photographs with measured responses, averaged per camera, and FILE.png with their curves.
"""

from __future__ import annotations

import argparse
import csv
import json
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path

import numpy as np
from scipy.stats import spearmanr
from tqdm import tqdm

from crfnet_core.estimate import ResponseEstimate, estimate_response
from crfnet_core.metrics import estimation_error, linearisation_error, ratio_to_gamma, win_rate
from crfnet_core.network import ResponseNetwork
from crfnet_core.photo import Photo, read_photo
from crfnet_core.response import SAMPLES, ResponseCurve
from training.curves import read_dorf
from training.scenes import Scene, dithered, read_scene, read_scenes, split_scenes
from training.synthesis import EXPOSURE_FACTORS, Capture, automatic_exposure, photographed, reference_luminance

GAMMA = ResponseCurve.gamma(2.2)


@dataclass(frozen=True)
class Case:
    """One photograph measured: the errors of the estimate and of gamma 2.2, and the uncertainty reported."""

    group: str
    photograph: str
    curve: str
    estimation: float
    linearisation: float
    gamma_estimation: float
    gamma_linearisation: float
    uncertainty: float
    band_coverage: float


def synthetic_photo(
    scene: Scene, curve: np.ndarray, exposure: float, rng: np.random.Generator, capture: Capture | None = None
) -> Photo:
    """Return the photograph of a whole scene; without `capture`, only 8-bit quantisation comes after the response."""
    pixels = dithered(scene.pixels, rng) if scene.is_panorama else scene.pixels
    codes = photographed(pixels * np.float32(exposure), curve, capture or Capture(), rng)
    return Photo(pixels=codes / np.float32(255), bit_depth=8, is_gray=False, path=Path(scene.name))


def measured(group: str, curve: str, photo: Photo, true: ResponseCurve, estimate: ResponseEstimate) -> Case:
    """Return the errors of an estimate on one photograph."""
    counts = np.bincount(np.rint(photo.pixels * 255).astype(np.uint8).ravel(), minlength=256)
    codes = np.arange(256) / 255
    inside = (true.brightness >= estimate.band[0]) & (true.brightness <= estimate.band[1])
    return Case(
        group=group,
        photograph=photo.path.name,
        curve=curve,
        estimation=estimation_error(true, estimate.curve),
        linearisation=linearisation_error(codes, true, estimate.curve, counts=counts),
        gamma_estimation=estimation_error(true, GAMMA),
        gamma_linearisation=linearisation_error(codes, true, GAMMA, counts=counts),
        uncertainty=estimate.uncertainty,
        band_coverage=float(inside.mean()),
    )


@cache
def _dorf(data: Path) -> np.ndarray:
    """Return the DoRF responses, read once per process."""
    return read_dorf(data / "dorf" / "201_CRF_data.mat")


@cache
def _exposures(data: Path) -> list[float]:
    """Return s_crf of every DoRF curve."""
    luminance = reference_luminance(read_scenes(data / "linear", "train"))
    return [automatic_exposure(curve, luminance) for curve in _dorf(data)]


def measure_scene(data: Path, model: Path | None, number: int, exposures: list[float], curve_step: int) -> list[Case]:
    """Return the cases of one test scene: every `curve_step`-th DoRF curve, the five exposure factors in turn."""
    network = ResponseNetwork.load(model, threads=1)
    name, is_panorama = split_scenes(data / "linear")["test"][number]
    scene, rng = read_scene(data / "linear" / name, is_panorama), np.random.default_rng([2017, number])
    cases = []
    for k in range(number % curve_step, len(exposures), curve_step):
        exposure = exposures[k] * EXPOSURE_FACTORS[(k + number) % len(EXPOSURE_FACTORS)]
        photo = synthetic_photo(scene, _dorf(data)[k], exposure, rng)
        true = ResponseCurve.from_samples(_dorf(data)[k])
        cases.append(measured(scene.name, f"dorf {k}", photo, true, estimate_response(photo, network=network)))
    return cases


def measure_p0(data: Path, model: Path | None, *, workers: int, curve_step: int = 1) -> list[Case]:
    """Return the cases of P0 over all test scenes."""
    exposures, scenes = _exposures(data), len(split_scenes(data / "linear")["test"])
    with ProcessPoolExecutor(workers) as pool:
        jobs = [pool.submit(measure_scene, data, model, n, exposures, curve_step) for n in range(scenes)]
        return [case for job in tqdm(jobs, unit="scene") for case in job.result()]


@dataclass(frozen=True)
class RealPhoto:
    """A real photograph measured: its case, and the curves to draw."""

    case: Case
    true: ResponseCurve
    estimate: ResponseEstimate


def measure_real(data: Path, model: Path | None) -> list[RealPhoto]:
    """Return the real photographs, each grouped under its camera and named by its grade."""
    network = ResponseNetwork.load(model)
    with (data / "real" / "cases.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    found = []
    for row in tqdm(rows, unit="photograph"):
        photo = read_photo(data / "real" / row["input_file"])
        samples = np.loadtxt(data / "real" / "gt" / f"{row['id']}.csv", delimiter=",", skiprows=1)
        estimate, true = estimate_response(photo, network=network), ResponseCurve.from_samples(samples[:, 1])
        found.append(RealPhoto(measured(row["camera"], row["grade"], photo, true, estimate), true, estimate))
    return found


def draw_curves(path: Path, photos: list[RealPhoto]) -> None:
    """Draw the true and the estimated response of every photograph, with its band and gamma 2.2, as PNG."""
    from matplotlib.figure import Figure

    columns = 4
    figure = Figure(figsize=(4 * columns, 3.4 * -(-len(photos) // columns)), layout="constrained")
    irradiance = np.linspace(0, 1, SAMPLES)
    for number, photo in enumerate(photos):
        axes = figure.add_subplot(-(-len(photos) // columns), columns, number + 1)
        axes.fill_between(irradiance, *photo.estimate.band, color="tab:blue", alpha=0.2, linewidth=0)
        axes.plot(irradiance, photo.estimate.curve.brightness, "tab:blue", label="estimate, 90 % band")
        axes.plot(irradiance, photo.true.brightness, "black", label="measured")
        axes.plot(irradiance, GAMMA.brightness, "gray", linestyle="--", label="gamma 2.2")
        case = photo.case
        title = f"{case.photograph}\nE_est {case.estimation:.2f}, expected {case.uncertainty:.2f}"
        axes.set_title(f"{title}, gamma {case.gamma_estimation:.2f}", fontsize=9)
    figure.axes[0].legend(fontsize=8)
    figure.savefig(path, dpi=90)


def summary(cases: list[Case]) -> dict[str, float]:
    """Return the figures of a protocol; E_lin is given x 1e-2."""
    column = {name: np.array([getattr(case, name) for case in cases]) for name in asdict(cases[0])}
    error, linear = column["estimation"], column["linearisation"]
    gamma, gamma_linear = column["gamma_estimation"], column["gamma_linearisation"]
    figures = {
        "E_est mean": error.mean(),
        "E_est median": np.median(error),
        "E_est p90": np.quantile(error, 0.9),
        "E_est gamma 2.2": gamma.mean(),
        "E_est ratio": ratio_to_gamma(error, gamma),
        "E_est win rate": win_rate(error, gamma),
        "E_lin mean": 100 * linear.mean(),
        "E_lin gamma 2.2": 100 * gamma_linear.mean(),
        "E_lin ratio": ratio_to_gamma(linear, gamma_linear),
        "E_lin win rate": win_rate(linear, gamma_linear),
        "uncertainty mean": column["uncertainty"].mean(),
        "uncertainty rank correlation": spearmanr(column["uncertainty"], error).statistic,
        "band coverage": column["band_coverage"].mean(),
    }
    return {"photographs": len(cases)} | {name: round(float(figure), 4) for name, figure in figures.items()}


def by_group(cases: list[Case]) -> dict[str, dict[str, float]]:
    """Return mean E_est of the estimate and of gamma 2.2 for every scene or camera."""
    groups = sorted({case.group for case in cases})
    chosen = {group: [case for case in cases if case.group == group] for group in groups}
    return {
        group: {
            "photographs": len(members),
            "E_est": round(float(np.mean([case.estimation for case in members])), 3),
            "gamma 2.2": round(float(np.mean([case.gamma_estimation for case in members])), 3),
            "uncertainty": round(float(np.mean([case.uncertainty for case in members])), 3),
        }
        for group, members in chosen.items()
    }


def main() -> None:
    """Measure, print and write the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf, linear and real")
    parser.add_argument("--model", type=Path, help="model folder; the packaged default otherwise")
    parser.add_argument("--real", action="store_true", help="real photographs instead of P0")
    parser.add_argument("--curve-step", type=int, default=1, help="every how many-th curve of a scene (quick looks)")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    if options.real:
        photos = measure_real(options.data, options.model)
        draw_curves(options.out.with_suffix(".png"), photos)
        cases = [photo.case for photo in photos]
    else:
        cases = measure_p0(options.data, options.model, workers=options.workers, curve_step=options.curve_step)
    report = {"summary": summary(cases), "groups": by_group(cases), "cases": [asdict(case) for case in cases]}
    options.out.write_text(json.dumps(report, indent=1) + "\n")
    print(json.dumps({"summary": report["summary"], "groups": report["groups"]}, indent=1))


if __name__ == "__main__":
    main()
