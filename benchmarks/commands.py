"""What the command costs: an estimate, its start, many photographs, a sequence."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from dataclasses import asdict
from functools import partial
from pathlib import Path

from benchmarks.costs import Cost, Figure, cost_of_command, medians, ratio
from benchmarks.pictures import made, make_frames, make_photograph, make_small_photographs
from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import inverse_response_lut
from crfnet_core import ResponseCurve
from crfnet_core.types import cores

#: Photographs of `crfnet estimate --each`, and frames of `crfnet linearize`.
PHOTOGRAPHS, FRAMES = 100, 100


def estimate(folder: Path, runs: int) -> Iterator[Figure]:
    """Yield what an estimate of 24 megapixels with all outputs costs beside a conversion to EXR."""
    photo = str(made(make_photograph, folder / "photo.jpg"))
    works = {
        "crfnet estimate": ["crfnet", "estimate", photo, "--out", f"{folder}/out", "--overwrite"],
        "oiiotool in.jpg -o out.exr": ["oiiotool", photo, "-o", f"{folder}/converted.exr"],
    }
    costs = medians({name: partial(cost_of_command, command) for name, command in works.items()}, runs)
    yield ratio("crfnet estimate, 24 megapixels, all outputs, against oiiotool in.jpg -o out.exr", "at most 1.4", costs)


def start(_: Path, runs: int) -> Iterator[Figure]:
    """Yield how long the core takes to import and the command to say how it is used."""
    works = {
        ("import crfnet_core", "at most 0.15"): ["python", "-c", "import crfnet_core"],
        ("crfnet --help", "at most 0.06"): ["crfnet", "--help"],
    }
    for (name, limit), command in works.items():
        cost = medians({name: partial(cost_of_command, command)}, 2 * runs)[name]
        yield Figure(name, "s", cost.wall, limit, asdict(cost))


def each(folder: Path, runs: int) -> Iterator[Figure]:
    """Yield how many times the photographs a second two cores estimate, beside one core."""
    photographs = folder / "photographs"
    photographs.mkdir()
    made(make_small_photographs, photographs, PHOTOGRAPHS)
    chosen = sorted(os.sched_getaffinity(0))[:2]
    works = {f"{count} cores": partial(_estimate_each, photographs, set(chosen[:count])) for count in (1, len(chosen))}
    figure = ratio("", "", medians(works, runs))
    name = f"crfnet estimate --each, {PHOTOGRAPHS} photographs a second, {len(chosen)} cores against one"
    yield Figure(name, "times", figure.value, "at least 1.8", figure.details)


def linearize(folder: Path, runs: int) -> Iterator[Figure]:
    """Yield what a sequence costs as linear plates, beside oiiotool with the same LUT, compression and threads."""
    frames, lut = folder / "plate.%d.jpg", folder / "lut.spi1d"
    made(make_frames, frames, FRAMES)
    write_lut(lut, inverse_response_lut(ResponseCurve.gamma()))
    ours, theirs = folder / "ours", folder / "theirs"
    transform = f"--ociofiletransform {lut} -d half --compression zips -o {theirs}/linear.%d.exr".split()
    oiiotool = ["oiiotool", "--threads", str(cores()), "--frames", f"1-{FRAMES}", str(frames), *transform]
    crfnet = ["crfnet", "linearize", str(frames), "--lut", str(lut), "--out", f"{ours}/linear.%d.exr"]
    works = {"crfnet": partial(_into_empty, ours, crfnet), "oiiotool": partial(_into_empty, theirs, oiiotool)}
    name = f"crfnet linearize, {FRAMES} 4K frames, against oiiotool --ociofiletransform"
    yield ratio(name, "at most 1.0", medians(works, runs))


def _estimate_each(photographs: Path, allowed: set[int]) -> Cost:
    """Estimate every photograph on some cores; no files are left."""
    out, before = photographs.with_name("each"), os.sched_getaffinity(0)
    shutil.rmtree(out, ignore_errors=True)
    os.sched_setaffinity(0, allowed)
    try:
        return cost_of_command(["crfnet", "estimate", "--each", str(photographs), "--out", str(out)])
    finally:
        os.sched_setaffinity(0, before)


def _into_empty(folder: Path, command: list[str]) -> Cost:
    """Run a command that writes into an empty folder."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    return cost_of_command(command)
