"""`crfnet calibrate`: the response of a camera, measured from an exposure stack, or from raw files and their JPEGs."""

import argparse
from pathlib import Path

from crfnet_core.calibration import calibrate_pairs, calibrate_stack, parse_times

from ... import pipeline
from ...options import OutputOptions
from ...report.calibration import Measured, calibration_lines, comparison_lines
from ...report.words import file_lines
from ..remedies import CommandError
from .printing import lost_document, lost_lines, prepare_matplotlib, print_result, progress_bar


def run(arguments: argparse.Namespace) -> None:
    """Measure a response, write every file, and print the result and how far another response is from it."""
    frames: list[Path] = arguments.photos
    outputs = OutputOptions(has_sheet=not arguments.no_sheet and prepare_matplotlib(), has_linear=False)
    plan = pipeline.plan_calibration(arguments.out, frames, outputs, name=arguments.name, overwrite=arguments.overwrite)
    other = pipeline.response_to_compare(arguments.compare) if arguments.compare else None
    calibration = _measured(arguments)
    comparison = calibration.compare(other) if other else None
    document, lost = pipeline.write_calibration(plan, calibration, comparison)
    lines = [
        *calibration_lines(calibration),
        *(comparison_lines(comparison) if comparison else []),
        "",
        f"Written to {arguments.out}:",
        *file_lines(plan.files, sheet="the curve, the points of every file and their residuals"),
        *lost_lines(plan.files.config, lost),
    ]
    print_result(document | lost_document(lost), lines, as_json=arguments.json)


def _measured(arguments: argparse.Namespace) -> Measured:
    """Return the response of a stack, or of raw files and their JPEGs."""
    seconds = parse_times(arguments.times) if arguments.times else None
    with progress_bar("frames") as progress:
        options = {"accept_edited": arguments.accept_edited, "progress": progress}
        if pipeline.is_pairs(arguments.photos):
            if seconds:
                raise CommandError("times_of_raw_files")
            return calibrate_pairs(arguments.photos, **options)
        return calibrate_stack(arguments.photos, seconds=seconds, **options)
