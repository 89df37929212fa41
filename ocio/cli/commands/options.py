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


def plate_arguments(options: PlateOptions) -> list[str]:
    """Return the arguments that make linear plates of the same kind; those that would be the defaults are left out."""
    chosen, usual = _arguments(options), _arguments(PlateOptions())
    return [word for name, value in chosen.items() if value != usual[name] for word in (name, value)]


def _arguments(options: PlateOptions) -> dict[str, str]:
    """Return the values of the arguments that say what kind of linear plates is written."""
    return {
        "--depth": options.depth,
        "--exposure": f"{options.exposure:g}" if options.gray is None else f"gray={options.gray:g}",
        "--primaries": options.primaries,
        "--output-space": options.output_space,
    }
