"""The options that `crfnet estimate` and `crfnet linearize` share, and `--each`: many photographs."""

import argparse
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

from crfnet_core.estimate.options import AnalysisOptions

from ... import pipeline
from ...configs.files import load_config
from ...configs.plate_color_space import plates_in_config
from ...defaults import CONFIG_NAME
from ...errors import PlateError
from ...options import EstimateOptions, PlateOptions, stated_device
from ...pipeline.batch import Batch
from ..remedies import CommandError
from .printing import print_result, progress_bar


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
        is_encoded=arguments.ignore_metadata or getattr(arguments, "encoded", False),
    )


def check_each(arguments: argparse.Namespace) -> None:
    """Raise CommandError for the options of --each where it is not given."""
    for name in ("workers", "scheduler"):
        if getattr(arguments, name) is not None and not arguments.each:
            raise CommandError("each_option_alone", name=name)


def run_each(arguments: argparse.Namespace, names: Iterable[str | Path], batch: Batch, key: str) -> list[str]:
    """Do a batch, print the records (in JSON as `key`) and return the verdicts; PlateError if a photograph failed."""
    if arguments.frames:
        raise CommandError("frames_of_each")
    photographs = pipeline.find_photographs(list(map(Path, names)), batch.out)
    with progress_bar("photographs") as progress:
        records = pipeline.run_batch(
            batch, photographs, workers=arguments.workers, scheduler=arguments.scheduler, progress=progress
        )
    document = {"folder": str(batch.out), key: [asdict(record) for record in records]}
    lines = [record.line for record in records]
    configs = sorted({batch.out / record.folder / CONFIG_NAME for record in records if record.lut})
    plates = [plate for path in configs if path.exists() for plate in plates_in_config(load_config(path))]
    if names := [plate.name for plate in plates if plate.name not in plate.rules.values()]:
        document["without_rule"] = names
        lines.append(f"note: no file rule leads to {', '.join(names)}: several plates have files of these names")
    lines += ["", f"All results in {batch.out}, one JSON line each: {batch.records.path}"]
    print_result(document, lines, as_json=arguments.json)
    if failed := [record for record in records if record.error]:
        raise PlateError("photographs_failed", failed=len(failed), count=len(records), problem=failed[0].error)
    return [record.verdict for record in records]
