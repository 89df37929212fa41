"""`crfnet estimate`: one response of all photographs, or one of each."""

from __future__ import annotations

import argparse
import shlex
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from importlib import import_module
from pathlib import Path
from typing import Any

from crfnet_core.errors import PhotoError

from ... import pipeline, report
from ...defaults import ESTIMATES
from ...movies.source import movie_of
from ...options import EstimateOptions, OutputOptions, PlateOptions
from ...output_files import OutputFiles, plain_stem
from ...pipeline import OutputPlan, PhotographEstimate, PhotographRecord
from .options import check_each, estimate_options, plate_arguments, plate_options
from .printing import prepare_matplotlib, print_earlier, print_json, print_left, print_lines, progress_bar


def run(arguments: argparse.Namespace) -> None:
    """Estimate one response of all photographs, or one of each; write every file; say what was found."""
    check_each(arguments)
    options = estimate_options(arguments, windows=arguments.windows, seed=arguments.seed)
    outputs = OutputOptions(
        lut_length=arguments.length,
        has_sheet=not arguments.no_sheet and prepare_matplotlib(),
        has_linear=not arguments.no_linear,
        has_forward=arguments.forward,
    )
    if arguments.each:
        _run_each(arguments, options, outputs)
        return
    photos = pipeline.sampled_photographs(arguments.photos, arguments.frames)
    plan = pipeline.plan_outputs(arguments.out, photos, plate_options(arguments), outputs)
    with ThreadPoolExecutor(1) as loader, progress_bar("windows") as progress:
        if outputs.has_sheet:
            loader.submit(import_module, "crfnet.report.sheet")  # matplotlib, on another core
        prior, network = pipeline.load_prior(options), pipeline.load_network(options)
        estimated = pipeline.estimate_photographs(
            photos, network, prior, options, frames=arguments.frames, progress=progress
        )
    document = pipeline.write_outputs(plan, estimated)
    if arguments.json:
        print_json({"folder": str(arguments.out), "estimates": [document], **plan.earlier.document})
    else:
        _print_estimate(estimated, document, plan)


def _run_each(arguments: argparse.Namespace, options: EstimateOptions, outputs: OutputOptions) -> None:
    """Estimate one response of each photograph; those that fail are named at the end."""
    if arguments.frames:
        raise PhotoError("--frames chooses the frames of one response, --each wants one of each photograph; drop one")
    photographs = pipeline.find_photographs(arguments.photos)
    tasks = pipeline.plan_each(arguments.out, photographs, options, plate_options(arguments), outputs)
    left = [path.relative_to(arguments.out).as_posix() for task in tasks for path in task.left]
    with progress_bar("photographs") as progress:
        records = pipeline.estimate_each(
            arguments.out, tasks, workers=arguments.workers, scheduler=arguments.scheduler, progress=progress
        )
    if arguments.json:
        document = {"folder": str(arguments.out), "estimates": [asdict(record) for record in records]}
        print_json(document | ({"left": left} if left else {}))
    else:
        written = (task.files for task, record in zip(tasks, records, strict=True) if not record.error)
        _print_records(records, next(written, None), arguments.out)
        print_left(left, "these estimates")
    pipeline.check_records(records)


def _print_estimate(estimated: PhotographEstimate, document: Mapping[str, Any], plan: OutputPlan) -> None:
    """Print what was read, found and written, and how to use it."""
    files = plan.files
    read = [*estimated.movies, *map(str, estimated.facts)]
    lines = [
        *read,
        *report.verdict_lines(estimated.estimate),
        *report.light_lines(document),
        *report.offer_lines(estimated.offers),
    ]
    print_lines([*lines, "", f"Written to {files.report.parent}:", *report.file_lines(files)])
    print_earlier(plan.earlier.document, files.config, "this estimate")
    print_lines([""])
    plate = estimated.plates[0]
    if movie_of(plate):
        print_lines([f"The linear plate is frame {plate.numbers[0]}; the whole movie, with the LUT:"])
        print_lines([f"  {_linearize_line(estimated.paths[0], files, plan.plates)}"])
        return
    print_lines(["The linear plate in oiiotool, with the LUT or the config:"])
    photo, alpha = estimated.paths[0], estimated.alphas[0]
    print_lines(f"  {line}" for line in report.oiiotool_lines(photo, files, document, alpha=alpha))


def _linearize_line(movie: Path, files: OutputFiles, plates: PlateOptions) -> str:
    """Return the command line by which all frames of a movie become linear plates like the one that was written."""
    frames = Path("linear", f"{plain_stem(movie)}.%04d.exr")
    command = ["crfnet", "linearize", str(movie), "--lut", str(files.lut), "--out", str(frames)]
    return shlex.join([*command, *plate_arguments(plates)])


def _print_records(records: Sequence[PhotographRecord], files: OutputFiles | None, folder: Path) -> None:
    """Print the result of each photograph in one line, and what was written: the files of one, if there are any."""
    print_lines([*(record.error or record.summary for record in records), ""])
    if files:
        lines = [line for line in report.file_lines(files) if files.config.name not in line or files.config.exists()]
        print_lines([f"Written to {folder}, for each photograph as for the first:", *lines])
    print_lines([f"All results, one JSON line each: {folder / ESTIMATES}"])
