"""Measure `crfnet calibrate` on stacks of known responses, beside OpenCV, or on raw pairs: docs/CALIBRATE.md's tables.

python -m tests.measure_calibration [--linear DIR] [--responses N] [--only NAME]
python -m tests.measure_calibration --pairs N [--bodies DATA/real_bodies] [--first N] [--verbose] [--linear DIR] ...

Scenes are the studio lights of tests/data/lights, or the linear pictures of another folder. Responses are those that
the packaged bank holds of cameras, EMoR draws, and the bundled photograph's, in turn; for pairs also the measured
ones of DATA/real_bodies. Thresholds of pairs were set, or changed, after draws before 300 and from 1000 to 1120.
"""

import argparse
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np

from crfnet_core.calibration import MeasuredResponse, calibrate_pairs, calibrate_stack
from crfnet_core.calibration.curve_model import in_camera_responses, in_file_codes
from crfnet_core.errors import CalibrationError
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import scale_error, shape_error
from tests.helpers.pairs import drawn_options, make_pair, spoil
from tests.helpers.stacks import StackOptions, emor_response, label_seconds, light_of, make_stack, opencv_response

DATA = Path(__file__).parent / "data"

KINDS = {
    "8 frames, 1 stop apart": StackOptions(),
    "the same, noisy (ISO 3200), JPEG 75": StackOptions(shot_noise=1e-3, read_noise=3e-3, quality=75),
    "12 frames, 1/3 stop apart": StackOptions(frames=12, step=1),
    "4 frames, 2 stops apart": StackOptions(frames=4, step=6),
    "white balance changes, 0.1 stop": StackOptions(balance=0.1),
    "handheld: shifted by up to 7 pixels": StackOptions(
        shifts=((0, 0), (1, 0), (0, -2), (3, 4), (0, 0), (-5, 7), (1, 1), (2, 0))
    ),
    "white is code 251": StackOptions(white=251 / 255),
    "no frame reaches white": StackOptions(brightest=97, ceiling=0.5),
}

#: Methods of OpenCV.
METHODS = ("Debevec", "Robertson")

#: Local tone mapping of simulated pairs, and ways to make two files that are not a pair.
LOCAL = {f"pairs, local tone mapping {part:.2f}": part for part in (0.0, 0.05, 0.15)}
WRONG = ("another scene", "moved", "cropped", "edited")

#: Other edits by programs that leave no name: the response stays, or is no longer the camera's.
EDITS = ("crop of 99 %", "flipped", "blurred", "vignette", "saturation", "levels of a channel", "tone curve")


def responses(count: int, first: int = 0) -> list[ResponseCurve]:
    """Return responses: cameras and EMoR draws in turn, from a number on; before number 0 the bundled photograph's."""
    table = np.loadtxt(DATA / "plate_response.csv", delimiter=",", skiprows=1)
    cameras = np.random.default_rng(7).permutation(in_camera_responses())
    drawn = [
        emor_response(100 + i) if i % 2 else ResponseCurve.from_samples(cameras[i % len(cameras)])
        for i in range(first, first + count)
    ]
    return drawn if first else [ResponseCurve.from_samples(table[:, 1]), *drawn[:-1]]


def pair_curves(count: int, bodies: Path | None, first: int) -> list[ResponseCurve]:
    """Return `count` responses: measured bodies and the others in turn."""
    files = sorted((bodies / "gt").glob("*.csv")) if bodies else []
    if bodies and not files:
        raise SystemExit(f"{bodies}: holds no gt/*.csv")
    order = [files[i] for i in np.random.default_rng(5).permutation(len(files))]
    known = [ResponseCurve.from_samples(np.loadtxt(path, delimiter=",", skiprows=1)[:, 1]) for path in order]
    others = iter(responses(count, first))
    return [known[i // 2] if i % 2 == 0 and i // 2 < len(known) else next(others) for i in range(count)]


def collected(measure: Callable[[Path, int], dict], count: int) -> tuple[dict[str, np.ndarray], list[str]]:
    """Return what is measured `count` times, by name, and the codes of what was refused."""
    rows, refused = [], []
    for index in range(count):
        with tempfile.TemporaryDirectory() as folder:
            try:
                rows.append(measure(Path(folder), index))
            except CalibrationError as problem:
                refused.append(problem.code)
    if not rows:
        raise SystemExit(f"all are refused: {dict(Counter(refused))}")
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}, refused


def errors(true: ResponseCurve, found: MeasuredResponse, begin: float) -> dict:
    """Return the errors of a measurement in stops and in stated deviations, and the processor time since `begin`."""
    shape, scale = shape_error(true, found.curve), abs(scale_error(true, found.curve))
    return {
        "seconds": time.process_time() - begin,
        "shape": shape,
        "scale": scale,
        "scores": (shape / found.uncertainty.shape_stops, scale / found.uncertainty.scale_stops),
    }


def stack_row(kind: str, scenes: list[Path], curves: list[ResponseCurve]) -> str:
    """Return a row of the table of stacks: median (largest)."""

    def measure(folder: Path, index: int) -> dict:
        options = StackOptions(**{**vars(KINDS[kind]), "seed": index})
        paths = make_stack(folder, light_of(scenes[index % len(scenes)]), curves[index], options)
        true, begin = in_file_codes(curves[index], options.white), time.process_time()
        row = errors(true, calibrate_stack(paths), begin)
        for method in METHODS:
            try:
                row[method] = shape_error(true, opencv_response(method, paths, label_seconds(options), true))
            except ValueError:
                row[method] = np.nan
        return row

    found, refused = collected(measure, len(curves))
    cells = [f"{np.median(found[name]):.3f} ({found[name].max():.3f})" for name in ("shape", "scale")]
    cells.append(", ".join(f"{np.nanmedian(found[name]):.3f}" for name in METHODS))
    cells.append(", ".join(f"{part:.0%}" for part in (found["scores"] < 2).mean(axis=0)))
    return f"| {kind} | {' | '.join(cells)} | {np.median(found['seconds']):.1f} | {dict(Counter(refused)) or ''} |"


def pair_lines(kind: str, scenes: list[Path], curves: list[ResponseCurve], *, first: int, verbose: bool) -> list[str]:
    """Return how good pairs of a kind are measured."""

    def measure(folder: Path, index: int) -> dict:
        scene, options = scenes[index % len(scenes)], drawn_options(first + index, local=LOCAL[kind])
        paths = make_pair(folder, light_of(scene), curves[index], options)
        begin = time.process_time()
        found = calibrate_pairs(paths)
        low, high = found.codes_seen
        row = errors(curves[index], found, begin) | {
            "local": found.local,
            "seen": low <= 25 and high >= 235,
            "basis": str(found.white_basis),
        }
        if verbose:
            print(index, scene.stem, row, flush=True)
        return row

    found, refused = collected(measure, len(curves))
    lines = [f"{kind}: {len(found['shape'])} measured; refused: {dict(Counter(refused))}"]
    for words, chosen in (("codes 25 to 235 seen", found["seen"]), ("all", np.ones(len(found["seen"]), dtype=bool))):
        within = [", ".join(f"{part:.0%}" for part in (found["scores"][chosen] < most).mean(axis=0)) for most in (1, 2)]
        spreads = [f"{name} {spread(found[name][chosen])}" for name in ("shape", "scale", "local", "seconds")]
        lines.append(f"{words} ({chosen.sum()}), median, 90 %, largest: {'; '.join(spreads)}; shape, scale within one")
        lines[-1] += f" deviation: {within[0]}; two: {within[1]}"
    return lines


def spread(values: np.ndarray) -> str:
    """Return median, 90 % and largest."""
    return ", ".join(f"{value:.3f}" for value in np.quantile(values, [0.5, 0.9, 1])) if len(values) else "-"


def spoiled_lines(kinds: tuple[str, ...], scenes: list[Path], curves: list[ResponseCurve], *, first: int) -> list[str]:
    """Return how many files that are not a pair, or are edited, are refused, and how wrong the others are."""
    codes: Counter[tuple[str, str]] = Counter()
    lines = []
    for index, curve in enumerate(curves):
        kind, options = kinds[index % len(kinds)], drawn_options(first + index)
        light, other = (light_of(scenes[number % len(scenes)]) for number in (index, index + 1))
        with tempfile.TemporaryDirectory() as folder:
            paths = make_pair(Path(folder), light, curve, options)
            spoil(kind, Path(folder), paths[1], other, light, curve, options)
            try:
                found = calibrate_pairs(paths)
                shape, stated = shape_error(curve, found.curve), found.uncertainty.shape_stops
                lines.append(f"measured: {kind}, shape {shape:.3f}, stated {stated:.3f}")
            except CalibrationError as problem:
                codes[kind, problem.code] += 1
    return [f"{codes.total()} of {len(curves)} refused: {dict(codes)}", *lines]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--linear", type=Path, default=DATA / "lights", help="folder of linear pictures, .exr")
    parser.add_argument("--responses", type=int, default=10, help="stacks of each kind (10)")
    parser.add_argument("--only", default="", help="kinds whose name holds this")
    parser.add_argument("--pairs", type=int, default=0, help="raw pairs of each kind, in the place of stacks")
    parser.add_argument("--bodies", type=Path, help="folder with gt/*.csv, measured responses such as DATA/real_bodies")
    parser.add_argument("--first", type=int, default=0, help="number of the first draw of pairs (0)")
    parser.add_argument("--verbose", action="store_true", help="a line for every pair")
    options = parser.parse_args()
    scenes = sorted(options.linear.glob("*.exr"))
    scenes = [scenes[i] for i in np.random.default_rng(3).permutation(len(scenes))]
    if not options.pairs:
        print("| stacks | shape | scale | Debevec, Robertson | within 2 deviations: shape, scale | CPU s | refused |")
        print("| --- | --- | --- | --- | --- | --- | --- |")
        for kind in (name for name in KINDS if options.only in name):
            print(stack_row(kind, scenes, responses(options.responses)), flush=True)
        return
    curves, first = pair_curves(options.pairs, options.bodies, options.first), options.first
    for kind in (name for name in LOCAL if options.only in name):
        print(*pair_lines(kind, scenes, curves, first=first, verbose=options.verbose), sep="\n", flush=True)
    for name, kinds in (("wrong", WRONG), ("edits", EDITS)):
        if options.only in name:
            print(f"{name}:", *spoiled_lines(kinds, scenes, curves, first=first), sep="\n", flush=True)


if __name__ == "__main__":
    main()
