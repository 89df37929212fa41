"""Measure models where the response is known.

    python -m training.evaluation --data DATA --out FOLDER [--model NAME_OR_FOLDER ...] [--protocol p0 p3 ...]
    python -m training.evaluation --quick --out FOLDER

writes FOLDER/report.json, report.md and PNGs. What was measured is kept in FOLDER/cases: an interrupted evaluation goes
on, and a finished one only writes its report anew. With --quick the repository's own lights and formulas take the place
of the data. P4 measures DATA/real and, where it is there, DATA/real_bodies. P5, the reliability of the uncertainty,
comes with P0, P2 and P4. P6 counts the pictures that must be refused and are not.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from pathlib import Path

from crfnet_core.errors import CRFNetError
from crfnet_core.network import DEFAULT_MODEL
from training.data.studio_lights import LIGHTS_FOLDER
from training.evaluation.plan import QUERIES
from training.evaluation.protocols import Evaluation
from training.evaluation.settings import ALL_PHOTOGRAPHS, PROTOCOLS, Model, Settings
from training.evaluation.test_sets import bundled_test_set, dorf_test_set

#: The protocols that the bundled lights are enough for, how many photographs of them are taken, and how many of these
#: under stress.
QUICK_PROTOCOLS, QUICK_PHOTOGRAPHS, QUICK_STRESS_PHOTOGRAPHS = ("p0", "p3"), 40, 5

#: The queries of --quick: those that cost little.
QUICK_QUERIES = tuple(query for query in QUERIES if query.pooled <= 2 and (query.windows or 0) <= 2)


def parser() -> argparse.ArgumentParser:
    """Return the command's parser."""
    command = argparse.ArgumentParser(
        prog="python -m training.evaluation", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    command.add_argument(
        "--data", type=Path, help="folder with dorf, linear, real and perhaps real_bodies; not needed with --quick"
    )
    command.add_argument("--out", type=Path, required=True, help="folder of the report and of the cases")
    command.add_argument(
        "--model", nargs="+", default=[DEFAULT_MODEL.name], help="names in crfnet_core/models, or model folders"
    )
    command.add_argument("--protocol", nargs="+", choices=PROTOCOLS, help="all that the models allow by default")
    command.add_argument(
        "--photographs",
        type=int,
        help="the most photographs in P0 and P2: an even, seeded part (all, or 40 with --quick)",
    )
    command.add_argument("--stressed", type=int, help="photographs of P3 (200, or 5 with --quick)")
    command.add_argument("--workers", type=int, default=2, help="processes")
    command.add_argument("--seed", type=int, default=2017)
    command.add_argument("--quick", action="store_true", help="bundled lights and formulas instead of the data")
    command.add_argument("--lights", type=Path, default=LIGHTS_FOLDER, help="folder of the lights of --quick")
    return command


def parsed(arguments: list[str] | None = None) -> Evaluation:
    """Return the evaluation that a command line asks for.

    Raises
    ------
    CRFNetError
        If neither data nor --quick is given, or a model or number is wrong.
    """
    options = parser().parse_args(arguments)
    if options.data is None and not options.quick:
        raise CRFNetError("there is nothing to measure on; give --data, or --quick for the bundled lights")
    if options.workers < 1:
        raise CRFNetError(f"the number of workers must be 1 or more, found {options.workers}")
    test_set = bundled_test_set(options.lights) if options.quick else dorf_test_set(options.data)
    models = tuple(Model.find(name) for name in options.model)
    settings = Settings(
        out=options.out,
        models=models,
        protocols=tuple(options.protocol or _possible(models, test_set.held_out, is_quick=options.quick)),
        photographs=_photographs(options),
        workers=options.workers,
        seed=options.seed,
    )
    if options.quick:
        settings = replace(settings, stress_photographs=QUICK_STRESS_PHOTOGRAPHS, queries=QUICK_QUERIES)
    if options.stressed is not None:
        settings = replace(settings, stress_photographs=options.stressed)
    return Evaluation(settings, test_set)


def _photographs(options: argparse.Namespace) -> int:
    """Return how many photographs are wanted."""
    if options.photographs is not None:
        return int(options.photographs)
    return QUICK_PHOTOGRAPHS if options.quick else ALL_PHOTOGRAPHS


def _possible(models: tuple[Model, ...], held_out: tuple[int, ...], *, is_quick: bool) -> tuple[str, ...]:
    """Return all protocols that the test set and the models' training allow."""
    if is_quick:
        return QUICK_PROTOCOLS
    return tuple(name for name in PROTOCOLS if name != "p2" or all(model.lacks(held_out) for model in models))


def main(arguments: list[str] | None = None) -> None:
    """Measure, and say where the report is."""
    started = time.monotonic()
    try:
        evaluation = parsed(arguments)
        evaluation.run()
    except CRFNetError as problem:
        raise SystemExit(str(problem)) from None
    print(f"wrote {evaluation.settings.out / 'report.md'} in {time.monotonic() - started:.0f} s")


if __name__ == "__main__":
    main()
