"""From the arguments of a subcommand to the options of the pipeline."""

from __future__ import annotations

import argparse

from crfnet_core.estimate.options import AnalysisOptions

from ...options import EstimateOptions, PlateOptions, stated_device


def estimate_options(arguments: argparse.Namespace) -> EstimateOptions:
    """Return how responses are estimated."""
    device = stated_device(arguments.taken_with)
    return EstimateOptions(
        model=arguments.model,
        prior=arguments.prior,
        camera=arguments.camera,
        analysis=AnalysisOptions(use_metadata=not arguments.ignore_metadata, device=device),
    )


def plate_options(arguments: argparse.Namespace) -> PlateOptions:
    """Return how linear plates are written."""
    return PlateOptions(
        depth=arguments.depth,
        exposure=arguments.exposure.stops,
        gray=arguments.exposure.gray,
        primaries=arguments.primaries,
        output_space=arguments.output_space,
        overwrite=arguments.overwrite,
        is_encoded=getattr(arguments, "encoded", False),
    )
