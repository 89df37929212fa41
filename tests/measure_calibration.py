"""Measure `crfnet calibrate` on stacks of known responses, beside OpenCV, or on raw pairs: docs/CALIBRATE.md's tables.

python -m tests.measure_calibration [--linear DIR] [--responses N] [--only NAME]
python -m tests.measure_calibration --pairs N [--linear DIR] [--bodies DIR] [--first N] [--only NAME] [--verbose]

Scenes are the studio lights of tests/data/lights, or the linear pictures of another folder. Responses are those that
the packaged bank holds of cameras, EMoR draws, and the bundled photograph's, in turn; for pairs also the measured
ones in a folder of CSV files. Thresholds of pairs were set, or changed, after draws before 300 and from 1000 to 1120.
"""

import argparse
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np

from crfnet_core.calibration import calibrate_pairs, calibrate_stack
from crfnet_core.calibration.curve_model import in_file_codes
from crfnet_core.errors import CalibrationError
from crfnet_core.posterior import IN_CAMERA, ResponseBank
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import estimation_error, linearization_error, scale_error, shape_error
from tests.helpers.pairs import drawn_options, make_pair, spoil
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

#: Local tone mapping of simulated pairs, and ways to make two files that are not a pair.
LOCAL = {f"pairs, local tone mapping {part:.2f}": part for part in (0.0, 0.05, 0.15)}
WRONG = ("another scene", "moved", "cropped", "edited")

#: Other edits by programs that leave no name: the response stays, or is no longer the camera's.
EDITS = ("crop of 99 %", "flipped", "blurred", "vignette", "saturation", "levels of a channel", "tone curve")


def responses(count: int, first: int = 0) -> list[ResponseCurve]:
    """Return responses: cameras and EMoR draws in turn, from a number on; before number 0 the bundled photograph's."""
    table = np.loadtxt(DATA / "plate_response.csv", delimiter=",", skiprows=1)
    bank, rng = ResponseBank.load(), np.random.default_rng(7)
    cameras = rng.permutation([i for i, family in enumerate(bank.families) if family in IN_CAMERA])
    drawn = [
        emor_response(100 + i) if i % 2 else ResponseCurve.from_samples(bank.brightness[cameras[i % len(cameras)]])
        for i in range(first, first + count)
    ]
    return drawn if first else [ResponseCurve.from_samples(table[:, 1]), *drawn[:-1]]


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


def pair_curves(count: int, bodies: Path | None, first: int) -> list[ResponseCurve]:
    """Return `count` responses: measured bodies and the others in turn."""
    files = sorted(bodies.glob("*.csv")) if bodies else []
    order = [files[i] for i in np.random.default_rng(5).permutation(len(files))]
    known = [ResponseCurve.from_samples(np.loadtxt(path, delimiter=",", skiprows=1)[:, 1]) for path in order]
    others = iter(responses(count, first))
    return [known[i // 2] if i % 2 == 0 and i // 2 < len(known) else next(others) for i in range(count)]


def measure_pair(folder: Path, light: np.ndarray, response: ResponseCurve, options) -> dict:
    """Return the errors of a simulated pair, its standard scores, and what was seen."""
    paths = make_pair(folder, light, response, options)
    begin = time.process_time()
    found = calibrate_pairs(paths)
    shape, scale = shape_error(response, found.curve), scale_error(response, found.curve)
    low, high = found.codes_seen
    return {
        "shape": shape,
        "scale": abs(scale),
        "shape score": shape / found.uncertainty.shape_stops,
        "scale score": abs(scale) / found.uncertainty.scale_stops,
        "local": found.local,
        "seen": low <= 25 and high >= 235,
        "basis": found.white_basis,
        "stated": found.uncertainty.shape_stops,
        "scale stated": found.uncertainty.scale_stops,
        "seconds": time.process_time() - begin,
    }


def measure_pairs(kind: str, local: float, scenes: list[Path], curves, *, first: int, verbose: bool) -> None:
    """Print the row of a kind of pairs."""
    found, refused = [], []
    for index in range(len(curves)):
        with tempfile.TemporaryDirectory() as folder:
            options = drawn_options(first + index, local=local)
            try:
                light = light_of(scenes[index % len(scenes)])
                found.append(measure_pair(Path(folder), light, curves[index], options))
            except CalibrationError as problem:
                refused.append(problem.code)
            if verbose:
                print(index, scenes[index % len(scenes)].stem, len(refused), found[-1:], flush=True)
    shape, scale = (np.array([row[name] for row in found]) for name in ("shape", "scale"))
    scores = np.array([[row["shape score"], row["scale score"]] for row in found])
    is_seen = np.array([row["seen"] for row in found], dtype=bool)
    within = [
        ", ".join(f"{part:.0%}" for part in (scores[chosen] < limit).mean(axis=0))
        for chosen in (is_seen, np.ones_like(is_seen))
        for limit in (1, 2)
    ]
    mapped, seconds = (spread(np.array([row[name] for row in found])) for name in ("local", "seconds"))
    print(
        f"{kind}: {len(found)} measured. Shape, median, 90 %, largest: {spread(shape[is_seen])} ({is_seen.sum()} with"
        f" codes 25 to 235 seen), {spread(shape)} (all). Scale: {spread(scale)}. Within 1 and 2 standard deviations"
        f" (shape, scale), seen, then all: {'; '.join(within)}. Local: {mapped}. CPU seconds: {seconds}."
        f" Refused {len(refused)}: {dict(Counter(refused))}",
        flush=True,
    )


def spread(values: np.ndarray) -> str:
    """Return median, 90 % and largest."""
    return ", ".join(f"{value:.3f}" for value in np.quantile(values, [0.5, 0.9, 1])) if len(values) else "-"


def measure_wrong(kinds: tuple[str, ...], count: int, scenes: list[Path], curves, *, first: int) -> None:
    """Print how many files that are not a pair, or are edited, are refused, and how wrong the others are."""
    accepted, codes = [], []
    for index in range(count):
        kind, seed = kinds[index % len(kinds)], first + index
        with tempfile.TemporaryDirectory() as folder:
            light, options = light_of(scenes[index % len(scenes)]), drawn_options(seed)
            raw, jpeg = make_pair(Path(folder), light, curves[index], options)
            other = light_of(scenes[(index + 1) % len(scenes)])
            spoil(kind, Path(folder), jpeg, other, light, curves[index], options)
            try:
                found = calibrate_pairs([raw, jpeg])
                error, stated = shape_error(curves[index], found.curve), found.uncertainty.shape_stops
                accepted.append(f"{kind} {index}: {error:.3f} ({stated:.3f})")
            except CalibrationError as problem:
                codes.append((kind, problem.code))
    print(f"{len(codes)} of {count} refused: {dict(Counter(codes))}", flush=True)
    print(f"accepted, with the error of the shape (and the stated one): {accepted}", flush=True)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--linear", type=Path, default=DATA / "lights", help="folder of linear pictures, .exr")
    parser.add_argument("--responses", type=int, default=10, help="stacks of each kind (10)")
    parser.add_argument("--only", default="", help="kinds whose name holds this")
    parser.add_argument("--pairs", type=int, default=0, help="raw pairs of each kind, in the place of stacks")
    parser.add_argument("--bodies", type=Path, help="folder of measured responses, .csv")
    parser.add_argument("--first", type=int, default=0, help="number of the first draw of pairs (0)")
    parser.add_argument("--verbose", action="store_true", help="a line for every pair")
    options = parser.parse_args()
    scenes = sorted(options.linear.glob("*.exr"))
    scenes = [scenes[i] for i in np.random.default_rng(3).permutation(len(scenes))]
    if options.pairs:
        curves, first = pair_curves(options.pairs, options.bodies, options.first), options.first
        for kind, local in LOCAL.items():
            if options.only in kind:
                measure_pairs(kind, local, scenes, curves, first=first, verbose=options.verbose)
        for name, kinds in (("wrong", WRONG), ("edits", EDITS)):
            if options.only in name:
                print(name, end=": ")
                measure_wrong(kinds, options.pairs, scenes, curves, first=first)
        return
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
