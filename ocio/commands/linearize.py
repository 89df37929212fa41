"""`crfnet linearize`: plates as linear EXR, through a LUT or an estimated response."""

from __future__ import annotations

import argparse
from pathlib import Path

from crfnet_core.estimate import ResponseEstimate
from ocio import pipeline, report
from ocio.commands.options import estimate_options, plate_options
from ocio.commands.printing import print_json, print_lines, progress_bar
from ocio.luts.files import read_lut
from ocio.output_files import check_folder, output_folder
from ocio.plates.frames import FrameSequence, find_frames
from ocio.plates.linear import linear_targets, linearize_plates


def run(arguments: argparse.Namespace) -> None:
    """Write plates as linear EXR through a LUT, or through a response estimated from several of the frames."""
    sequence = find_frames(arguments.plates, arguments.frames)
    targets = linear_targets(arguments.out, sequence)
    folder = Path(arguments.out).parent
    check_folder(folder)
    estimate = None if arguments.lut else _estimate_frames(sequence, arguments)
    lut = pipeline.response_lut(estimate) if estimate else read_lut(arguments.lut)
    with output_folder(folder), progress_bar("frames") as progress:
        done = linearize_plates(sequence, targets, lut, plate_options(arguments), progress=progress)
    document = report.plate_document(done, estimate)
    if arguments.json:
        print_json(document)
    else:
        lines = [report.source_line(estimate), *report.verdict_lines(estimate)] if estimate else []
        print_lines([*lines, *report.light_lines(document), *report.plate_lines(done)])


def _estimate_frames(sequence: FrameSequence, arguments: argparse.Namespace) -> ResponseEstimate:
    """Return the response of a sequence, with a progress bar."""
    options = estimate_options(arguments)
    prior, network = pipeline.load_prior(options), pipeline.load_network(options)
    with progress_bar("windows") as progress:
        return pipeline.estimate_frames(sequence, network, prior, options, progress=progress)
