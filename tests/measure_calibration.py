"""Measure `crfnet calibrate` on stacks of known responses, beside OpenCV: the table of docs/CALIBRATE.md.

python -m tests.measure_calibration [--linear DIR] [--responses N] [--only NAME]

Scenes are the studio lights of tests/data/lights, or the linear pictures of another folder. Responses are those that
the packaged bank holds of cameras, EMoR draws, and the bundled photograph's, in turn.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np

from crfnet_core.calibration import calibrate_stack
from crfnet_core.calibration.curve_model import in_file_codes
from crfnet_core.errors import CalibrationError
from crfnet_core.posterior import IN_CAMERA, ResponseBank
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import estimation_error, linearization_error, scale_error, shape_error
from tests.helpers.stacks import StackOptions, emor_response, label_seconds, light_of, make_stack, opencv_response

DATA = Path(__file__).parent / "data"

KINDS = {
    "8 frames, 1 stop apart": StackOptions(),
    "the same, PNG": StackOptions(quality=0),
    "the same, noisy (ISO 3200), JPEG 75": StackOptions(shot_noise=1e-3, read_noise=3e-3, quality=75),
    "12 frames, 1/3 stop apart": StackOptions(frames=12, step=1),
    "5 frames, 2 stops apart": StackOptions(frames=5, step=6),
    "4 frames, 2 stops apart": StackOptions(frames=4, step=6),
    "white balance changes, 0.1 stop": StackOptions(balance=0.1),
    "handheld: shifted by up to 7 pixels": StackOptions(
        shifts=((0, 0), (1, 0), (0, -2), (3, 4), (0, 0), (-5, 7), (1, 1), (2, 0))
    ),
    "white is code 251": StackOptions(white=251 / 255),
    "no frame reaches white": StackOptions(brightest=97, ceiling=0.5),
}


def responses(count: int) -> list[ResponseCurve]:
    """Return the responses: the bundled photograph's, then cameras and EMoR draws in turn."""
    table = np.loadtxt(DATA / "plate_response.csv", delimiter=",", skiprows=1)
    bank, rng = ResponseBank.load(), np.random.default_rng(7)
    cameras = rng.permutation([i for i, family in enumerate(bank.families) if family in IN_CAMERA])
    drawn = [
        emor_response(100 + i) if i % 2 else ResponseCurve.from_samples(bank.brightness[cameras[i]])
        for i in range(count - 1)
    ]
    return [ResponseCurve.from_samples(table[:, 1]), *drawn]


def errors(true: ResponseCurve, found: ResponseCurve, counts: np.ndarray) -> tuple[float, float, float, float]:
    """Return shape and scale errors in stops, E_est and E_lin."""
    return (
        shape_error(true, found),
        abs(scale_error(true, found)),
        estimation_error(true, found),
        linearization_error(np.arange(256) / 255, true, found, counts=counts),
    )


def measure(options: StackOptions, scenes: list[Path], curves: list[ResponseCurve]) -> dict[str, list]:
    """Return the errors of every method on a stack of every response, and of ours the standard scores and the time."""
    found: dict[str, list] = {name: [] for name in ("crfnet", "Debevec", "Robertson", "scores", "seconds", "refused")}
    for index, response in enumerate(curves):
        with tempfile.TemporaryDirectory() as folder:
            stack = StackOptions(**{**vars(options), "seed": index})
            paths = make_stack(Path(folder), light_of(scenes[index % len(scenes)]), response, stack)
            true = in_file_codes(response, stack.white)
            begin = time.process_time()
            try:
                ours = calibrate_stack(paths)
            except CalibrationError as problem:
                found["refused"].append(str(problem))
                continue
            found["seconds"].append(time.process_time() - begin)
            found["crfnet"].append(errors(true, ours.curve, ours.counts))
            shape, scale = found["crfnet"][-1][:2]
            found["scores"].append((shape / ours.uncertainty.shape_stops, scale / ours.uncertainty.scale_stops))
            for method in ("Debevec", "Robertson"):
                try:
                    curve = opencv_response(method, paths, label_seconds(stack), true)
                except ValueError:
                    found[method].append((np.nan,) * 4)
                    continue
                found[method].append(errors(true, curve, ours.counts))
    return found


def row(kind: str, found: dict[str, list]) -> str:
    """Return a row of the table: median (largest)."""
    ours = np.array(found["crfnet"])
    cells = [f"{np.median(values):.3f} ({values.max():.3f})" for values in ours.T[[0, 1]]]
    cells += [f"{np.median(values):.2f} ({values.max():.2f})" for values in ours.T[[2]]]
    cells += [f"{np.median(ours[:, 3]):.4f}"]
    for method in ("Debevec", "Robertson"):
        theirs = np.array(found[method])
        failed = f" ({int(np.isnan(theirs[:, 0]).sum())} failed)" if np.isnan(theirs).any() else ""
        known = theirs[~np.isnan(theirs[:, 0])]
        cells.append(f"{np.median(known[:, 0]):.3f}, {np.median(known[:, 2]):.2f}{failed}" if len(known) else "failed")
    within = (np.array(found["scores"]) < 2).mean(axis=0)
    cells += [f"{within[0]:.0%}, {within[1]:.0%}", f"{np.median(found['seconds']):.1f}"]
    return f"| {kind} | {len(ours)} | " + " | ".join(cells) + " |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--linear", type=Path, default=DATA / "lights", help="folder of linear pictures, .exr")
    parser.add_argument("--responses", type=int, default=10, help="stacks of each kind (10)")
    parser.add_argument("--only", default="", help="kinds whose name holds this")
    options = parser.parse_args()
    scenes = sorted(options.linear.glob("*.exr"))
    scenes = [scenes[i] for i in np.random.default_rng(3).permutation(len(scenes))]
    print(
        "| stacks | number | shape, stops | scale, stops | E_est | E_lin | Debevec: shape, E_est"
        " | Robertson: shape, E_est | within 2 standard deviations: shape, scale | CPU s |\n"
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    )
    for kind, stack in KINDS.items():
        if options.only in kind:
            found = measure(stack, scenes, responses(options.responses))
            print(row(kind, found), flush=True)
            for problem in found["refused"]:
                print(f"refused: {problem}", flush=True)


if __name__ == "__main__":
    main()
