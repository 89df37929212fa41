"""`crfnet linearize`: plates as linear EXR, through a LUT or an estimated response."""

from __future__ import annotations

import argparse
from dataclasses import asdict
from pathlib import Path

from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.posterior import Verdict

from ... import pipeline, report
from ...defaults import PLATES
from ...luts.response import ResponseFile, read_response
from ...luts.rgb_lut import AnyLut
from ...movies.source import PlateSource, find_source, movie_of
from ...movies.stream import check_progressive
from ...output_files import check_folder, output_folder
from ...plates.frame_pattern import FramePattern
from ...plates.linear import linear_targets, linearize_plates
from ..arguments.parts import NOT_TRUSTED
from ..remedies import CommandError
from .options import check_each, estimate_options, plate_options
from .printing import check_records, print_json, print_lines, progress_bar


def run(arguments: argparse.Namespace) -> int:
    """Write plates as linear EXR through a LUT, a stored camera's response, or one estimated from the frames."""
    check_each(arguments)
    if arguments.lut and arguments.camera:
        raise CommandError("two_responses")
    verdicts = _run_each(arguments) if arguments.each else _run_one(arguments)
    return NOT_TRUSTED if arguments.strict and Verdict.DO_NOT_TRUST in verdicts else 0


def _run_one(arguments: argparse.Namespace) -> list[str]:
    """Write one plate or sequence as linear EXR; return the verdict of the response, if it is estimated."""
    if len(arguments.plates) > 1:
        raise CommandError("several_plates", count=len(arguments.plates))
    sequence = find_source(arguments.plates[0], arguments.frames)
    if movie := movie_of(sequence):
        check_progressive(movie)
    _check_single(arguments.out, sequence)
    targets = linear_targets(arguments.out, sequence)
    folder = arguments.out.parent
    check_folder(folder)
    estimate = None if arguments.lut else _response(sequence, arguments)
    lut: AnyLut
    if estimate:
        lut, lines = pipeline.response_lut(estimate), [report.source_line(estimate), *report.verdict_lines(estimate)]
    else:
        found = read_response(arguments.lut)
        lut, lines = found.lut, _lut_lines(found)
    with output_folder(folder), progress_bar("frames") as progress:
        done = linearize_plates(sequence, targets, lut, plate_options(arguments), progress=progress)
    document = report.plate_document(done, estimate)
    if arguments.json:
        print_json(document | ({"movie": str(movie)} if movie else {}))
    else:
        read = [str(movie)] if movie else []
        print_lines([*read, *lines, *report.light_lines(document), *report.plate_lines(done)])
    return [estimate.verdict] if estimate else []


def _check_single(out: Path, sequence: PlateSource) -> None:
    """Refuse the pattern of a sequence for a single file whose own name is none: the file would be called so."""
    plate = sequence.paths[0]
    if not sequence.numbers and FramePattern.parse(out) and FramePattern.parse(plate) is None:
        raise CommandError("pattern_for_file", path=out, plate=plate)


def _run_each(arguments: argparse.Namespace) -> list[str]:
    """Write each photograph as linear EXR; return the verdicts. Those that fail are named at the end."""
    if arguments.frames:
        raise CommandError("frames_of_each")
    out: Path = arguments.out
    photographs = pipeline.find_photographs([Path(name) for name in arguments.plates])
    options, plates = estimate_options(arguments), plate_options(arguments)
    batch = pipeline.LinearBatch(out=out, options=options, plates=plates, lut=arguments.lut)
    with progress_bar("photographs") as progress:
        records = pipeline.linearize_each(
            batch, photographs, workers=arguments.workers, scheduler=arguments.scheduler, progress=progress
        )
    if arguments.json:
        print_json({"folder": str(out), "photographs": [asdict(record) for record in records]})
    else:
        print_lines(record.error or f"{record.linear}: {record.summary}" for record in records)
        print_lines(["", f"Written to {out}. All results, one JSON line each: {out / PLATES}"])
    check_records(records)
    return [record.verdict for record in records]


def _lut_lines(found: ResponseFile) -> list[str]:
    """Return a line on a LUT that is inverted; none for the usual inverse response."""
    return [f"{found.path.name}: {found.words}; its inverse is used."] if found.was_forward else []


def _response(sequence: PlateSource, arguments: argparse.Namespace) -> ResponseEstimate:
    """Return the response of a stored camera, or that of a sequence, with a progress bar."""
    options = estimate_options(arguments)
    if stored := pipeline.load_camera_response(options):
        return stored
    with progress_bar("windows") as progress:
        return pipeline.estimate_files([sequence], options, progress=progress).estimate
