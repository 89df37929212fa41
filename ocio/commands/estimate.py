"""`crfnet estimate`: one response of all photographs, or one of each."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from typing import Any

from ocio import pipeline, report
from ocio.commands.options import estimate_options, plate_options
from ocio.commands.printing import print_json, print_lines, progress_bar
from ocio.pipeline import OutputPlan, PhotographEstimate

NO_MATPLOTLIB = "crfnet: no sheet is drawn, matplotlib is absent: pip install 'crfnet[plot]', or add --no-sheet"


def run(arguments: argparse.Namespace) -> None:
    """Estimate one response of all photographs, or one of each; write every file; say what was found."""
    groups = [(photo,) for photo in arguments.photos] if arguments.each else [tuple(arguments.photos)]
    has_sheet = not arguments.no_sheet and _has_matplotlib()
    plan = pipeline.plan_outputs(
        arguments.out, groups, plate_options(arguments), lut_length=arguments.length, has_sheet=has_sheet
    )
    options = estimate_options(arguments, windows=arguments.windows, seed=arguments.seed)
    prior, network = pipeline.load_prior(options), pipeline.load_network(options)
    estimates = []
    for group in groups:
        with progress_bar("windows") as progress:
            estimates.append(pipeline.estimate_photographs(group, network, prior, options, progress=progress))
    documents = pipeline.write_estimates(plan, estimates)
    if arguments.json:
        print_json({"folder": str(plan.folder), "estimates": documents})
    else:
        _print_estimates(estimates, documents, plan)


def _has_matplotlib() -> bool:
    """Return whether a sheet can be drawn; if not, say on stderr what to do."""
    if find_spec("matplotlib") is not None:
        return True
    print(NO_MATPLOTLIB, file=sys.stderr)  # noqa: T201
    return False


def _print_estimates(
    estimates: Sequence[PhotographEstimate], documents: Sequence[Mapping[str, Any]], plan: OutputPlan
) -> None:
    """Print what was read, found and written, and how to use it; one line each if there are several estimates."""
    first, *others = estimates
    outputs, folder = plan.outputs, plan.folder
    light = report.light_lines(documents[0])
    if others:
        print_lines([*(report.result_line(estimated.estimate) for estimated in estimates), ""])
        print_lines([f"Of {first.facts[0].name}:", *light, ""])
        print_lines([f"Written to {folder}, for each photograph as for the first:"])
    else:
        print_lines([*map(str, first.facts), *report.verdict_lines(first.estimate), *light, ""])
        print_lines([f"Written to {folder}:"])
    print_lines([*report.file_lines(outputs[0]), "", "The linear plate in oiiotool, with the LUT or the config:"])
    print_lines(f"  {line}" for line in report.oiiotool_lines(first.paths[0], outputs[0]))
