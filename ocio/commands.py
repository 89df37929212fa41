"""What the subcommands of `crfnet` do: read the arguments of `ocio.cli`, run `ocio.pipeline`, show what came of it."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from tqdm import tqdm

from crfnet_core.errors import ModelError
from crfnet_core.estimate import ResponseEstimate
from crfnet_core.network import ResponseNetwork, model_folder
from crfnet_core.types import Progress
from ocio import pipeline, report
from ocio.luts.files import READERS, read_lut
from ocio.options import EstimateOptions, PlateOptions
from ocio.output_files import OutputFiles, check_folder, output_folder
from ocio.pipeline import PhotographEstimate
from ocio.plates.frames import FrameSequence, find_frames
from ocio.plates.linear import linear_targets, linearize_plates

#: Names of the files of a model; either of them stands for its folder.
MODEL_FILES = ("model.json", "model.onnx")

NO_MATPLOTLIB = "crfnet: no sheet is drawn, matplotlib is absent: pip install 'crfnet[plot]', or add --no-sheet"


def run_estimate(arguments: argparse.Namespace) -> None:
    """Estimate one response of all photographs, or one of each; write every file; say what was found."""
    groups = [(photo,) for photo in arguments.photos] if arguments.each else [tuple(arguments.photos)]
    has_sheet = not arguments.no_sheet and _has_matplotlib()
    plan = pipeline.plan_outputs(
        arguments.out, groups, _plate_options(arguments), lut_length=arguments.length, has_sheet=has_sheet
    )
    options = _estimate_options(arguments, windows=arguments.windows, seed=arguments.seed)
    prior, network = pipeline.load_prior(options), pipeline.load_network(options)
    estimates = []
    for group in groups:
        with _progress_bar("windows") as progress:
            estimates.append(pipeline.estimate_photographs(group, network, prior, options, progress=progress))
    documents = pipeline.write_estimates(plan, estimates)
    if arguments.json:
        _print_json({"folder": str(plan.folder), "estimates": documents})
    else:
        _print_estimates(estimates, plan.outputs, plan.folder)


def run_linearize(arguments: argparse.Namespace) -> None:
    """Write plates as linear EXR through a LUT, or through a response estimated from several of the frames."""
    sequence = find_frames(arguments.plates, arguments.frames)
    targets = linear_targets(arguments.out, sequence)
    folder = Path(arguments.out).parent
    check_folder(folder)
    estimate = None if arguments.lut else _estimate_frames(sequence, arguments)
    lut = pipeline.response_lut(estimate) if estimate else read_lut(arguments.lut)
    with output_folder(folder), _progress_bar("frames") as progress:
        done = linearize_plates(sequence, targets, lut, _plate_options(arguments), progress=progress)
    if arguments.json:
        _print_json(report.plate_document(done, estimate))
    else:
        lines = [report.source_line(estimate), *report.verdict_lines(estimate)] if estimate else []
        _print_lines([*lines, *report.plate_lines(done)])


def run_info(arguments: argparse.Namespace) -> None:
    """Say what a LUT file or a model folder holds."""
    subject: Path = arguments.subject
    if subject.suffix.lower() in READERS:
        document = report.lut_document(subject, read_lut(subject))
        lines = report.lut_lines(document)
    elif (folder := model_folder(subject.parent if subject.name in MODEL_FILES else subject)).is_dir():
        document = report.model_document(ResponseNetwork.load(folder).config)
        lines = report.model_lines(document)
    else:
        raise ModelError(f"{subject}: is neither a LUT ({', '.join(READERS)}) nor a model folder; give one of these")
    if arguments.json:
        _print_json(document)
    else:
        _print_lines(lines)


def _estimate_options(arguments: argparse.Namespace, **more: int) -> EstimateOptions:
    """Return how responses are estimated, with the options that not every command has."""
    return EstimateOptions(
        model=arguments.model,
        threads=arguments.threads,
        prior=arguments.prior,
        use_metadata=not arguments.ignore_metadata,
        **more,
    )


def _plate_options(arguments: argparse.Namespace) -> PlateOptions:
    """Return how linear plates are written."""
    return PlateOptions(depth=arguments.depth, exposure=arguments.exposure, overwrite=arguments.overwrite)


def _estimate_frames(sequence: FrameSequence, arguments: argparse.Namespace) -> ResponseEstimate:
    """Return the response of a sequence, with a progress bar."""
    options = _estimate_options(arguments)
    prior, network = pipeline.load_prior(options), pipeline.load_network(options)
    with _progress_bar("windows") as progress:
        return pipeline.estimate_frames(sequence, network, prior, options, progress=progress)


def _has_matplotlib() -> bool:
    """Return whether a sheet can be drawn; if not, say on stderr what to do."""
    if find_spec("matplotlib") is not None:
        return True
    print(NO_MATPLOTLIB, file=sys.stderr)  # noqa: T201
    return False


def _print_estimates(estimates: Sequence[PhotographEstimate], outputs: Sequence[OutputFiles], folder: Path) -> None:
    """Print what was read, found and written, and how to use it; one line each if there are several estimates."""
    first, *others = estimates
    if others:
        _print_lines([*(report.result_line(estimated.estimate) for estimated in estimates), ""])
        _print_lines([f"Written to {folder}, for each photograph as for the first:"])
    else:
        _print_lines([*map(str, first.facts), *report.verdict_lines(first.estimate), "", f"Written to {folder}:"])
    _print_lines([*report.file_lines(outputs[0]), "", "The linear plate in oiiotool, with the LUT or the config:"])
    _print_lines(f"  {line}" for line in report.oiiotool_lines(first.paths[0], outputs[0]))


def _print_json(document: Mapping[str, Any]) -> None:
    """Print a JSON document."""
    sys.stdout.write(report.json_text(document))


def _print_lines(lines: Iterable[str]) -> None:
    """Print lines."""
    sys.stdout.writelines(f"{line}\n" for line in lines)


@contextmanager
def _progress_bar(unit: str) -> Iterator[Progress | None]:
    """Yield a callback that moves a bar on stderr, or None where stderr is no terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    with tqdm(unit=f" {unit}", leave=False, file=sys.stderr) as bar:

        def show(done: int, total: int) -> None:
            bar.total = total
            bar.update(done - bar.n)

        yield show
