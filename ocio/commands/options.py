"""From the arguments of a subcommand to the options of the pipeline."""

from __future__ import annotations

import argparse

from ocio.options import EstimateOptions, PlateOptions


def estimate_options(arguments: argparse.Namespace, **more: int) -> EstimateOptions:
    """Return how responses are estimated, with the options that not every command has."""
    return EstimateOptions(
        model=arguments.model,
        threads=arguments.threads,
        prior=arguments.prior,
        use_metadata=not arguments.ignore_metadata,
        camera=arguments.camera,
        **more,
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
