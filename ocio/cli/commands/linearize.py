"""`crfnet linearize`: plates as linear EXR, through a LUT or an estimated response."""

import argparse

from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.photograph.image_io.file_kinds import file_kind
from crfnet_core.posterior import Verdict

from ... import pipeline
from ...luts.response import read_response
from ...luts.rgb_lut import AnyLut
from ...movies.source import PlateSource, find_source, movie_of
from ...movies.stream import check_progressive
from ...output_files import check_folder, output_folder
from ...plates.frame_pattern import FramePattern
from ...plates.linear import linear_targets, linearize_plates
from ...report import words
from ...report.documents import plate_document
from ..arguments.parts import NOT_TRUSTED
from ..remedies import CommandError
from .each import check_each, estimate_options, plate_options, run_each
from .printing import print_result, progress_bar


def run(arguments: argparse.Namespace) -> int:
    """Write plates as linear EXR through a LUT, a stored camera's response, or one estimated from the frames."""
    check_each(arguments)
    if arguments.lut and arguments.camera:
        raise CommandError("two_responses")
    if arguments.each:
        options, plates = estimate_options(arguments), plate_options(arguments)
        batch = pipeline.LinearBatch(out=arguments.out, options=options, plates=plates, lut=arguments.lut)
        verdicts = run_each(arguments, arguments.plates, batch, "photographs")
    else:
        verdicts = _run_one(arguments)
    return NOT_TRUSTED if arguments.strict and Verdict.DO_NOT_TRUST in verdicts else 0


def _run_one(arguments: argparse.Namespace) -> list[str]:
    """Write one plate or sequence as linear EXR; return the verdict of the response, if it is estimated."""
    if len(arguments.plates) > 1:
        raise CommandError("several_plates", count=len(arguments.plates))
    sequence = find_source(arguments.plates[0], arguments.frames)
    if movie := movie_of(sequence):
        check_progressive(movie)
    if not sequence.numbers and FramePattern.parse(arguments.out) and not FramePattern.parse(sequence.paths[0]):
        file_kind(sequence.paths[0])  # refuses what is empty or of no known format, for this reason
        raise CommandError("pattern_for_file", path=arguments.out, plate=sequence.paths[0])
    targets = linear_targets(arguments.out, sequence)
    folder = arguments.out.parent
    check_folder(folder)
    lut, estimate, lines = _response(sequence, arguments)
    with output_folder(folder), progress_bar("frames") as progress:
        done = linearize_plates(sequence, targets, lut, plate_options(arguments), progress=progress)
    document = plate_document(done, estimate)
    read = {"movie": str(movie)} if movie else {}
    lines = [*read.values(), *lines, *words.light_lines(document), *words.plate_lines(done)]
    print_result(document | read, lines, as_json=arguments.json)
    return [estimate.verdict] if estimate else []


def _response(
    sequence: PlateSource, arguments: argparse.Namespace
) -> tuple[AnyLut, ResponseEstimate | None, list[str]]:
    """Return the LUT of a file, of a stored camera or estimated from a sequence; its estimate; and lines about it."""
    if arguments.lut:
        response = read_response(arguments.lut)
        inverted = [f"{response.path.name}: {response.words}; its inverse is used."] if response.was_forward else []
        return response.lut, None, inverted
    options = estimate_options(arguments)
    if stored := pipeline.load_camera_response(options):
        return pipeline.response_lut(stored), stored, words.verdict_lines(stored)
    with progress_bar("windows") as progress:
        estimate = pipeline.estimate_files([sequence], options, progress=progress).estimate
    return pipeline.response_lut(estimate), estimate, [words.source_line(estimate), *words.verdict_lines(estimate)]
