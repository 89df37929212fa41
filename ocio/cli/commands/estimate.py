"""`crfnet estimate`: one response of all photographs, or one of each."""

import argparse
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module
from typing import Any

from crfnet_core.posterior import Verdict

from ... import pipeline
from ...options import OutputOptions
from ...report import words
from ..arguments.parts import NOT_TRUSTED
from .each import check_each, estimate_options, plate_options, run_each
from .printing import lost_document, lost_lines, prepare_matplotlib, print_result, progress_bar


def run(arguments: argparse.Namespace) -> int:
    """Estimate one response of all photographs, or one of each; write every file, print the results."""
    check_each(arguments)
    outputs = OutputOptions(
        has_sheet=not arguments.no_sheet and prepare_matplotlib(),
        has_linear=not arguments.no_linear,
        has_forward=arguments.forward,
    )
    if arguments.each:
        options, plates = estimate_options(arguments), plate_options(arguments)
        batch = pipeline.EstimateBatch(out=arguments.out, options=options, plates=plates, outputs=outputs)
        verdicts = run_each(arguments, arguments.photos, batch, "estimates")
    else:
        verdicts = [_run_one(arguments, outputs)]
    return NOT_TRUSTED if arguments.strict and Verdict.DO_NOT_TRUST in verdicts else 0


def _run_one(arguments: argparse.Namespace, outputs: OutputOptions) -> str:
    """Estimate one response of all photographs; return its verdict."""
    options, sources = estimate_options(arguments), pipeline.photograph_sources(arguments.photos, arguments.frames)
    paths = [source.paths[0] for source in sources]
    sequence = pipeline.sequence_of(sources)
    plan = pipeline.plan_outputs(arguments.out, paths, plate_options(arguments), outputs, sequence=sequence)
    with ThreadPoolExecutor(1) as loader, progress_bar("windows") as progress:
        if outputs.has_sheet:
            loader.submit(import_module, "crfnet.report.sheet")  # matplotlib, on another core
        estimated = pipeline.estimate_files(sources, options, progress=progress)
    light = pipeline.estimated_light(estimated, plan.plates)
    document, lost = pipeline.deliver_estimate(plan, estimated, light)
    printed = {"folder": str(arguments.out), "estimates": [document], **lost_document(lost)}
    lines = [*_lines(estimated, document, plan), *lost_lines(plan.files.config, lost)]
    print_result(printed, lines, as_json=arguments.json)
    return estimated.estimate.verdict


def _lines(estimated: pipeline.FileEstimate, document: Mapping[str, Any], plan: pipeline.OutputPlan) -> list[str]:
    """Return what was read, estimated and written, for people."""
    return [
        *estimated.movies,
        *(str(photograph.entry) for photograph in estimated.photographs),
        *words.verdict_lines(estimated.estimate),
        *words.light_lines(document),
        *words.offer_lines(estimated.offers),
        "",
        f"Written to {plan.files.report.parent}:",
        *words.file_lines(plan.files),
    ]
