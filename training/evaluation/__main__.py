"""Measure models where the response is known.

    python -m training.evaluation --data DATA --out FOLDER [--model NAME_OR_FOLDER ...] [--protocol p0 paper ...]
    python -m training.evaluation --quick --out FOLDER

writes FOLDER/photographs.jsonl, a row for each photograph and estimator, and from it report.json and report.md. Rows
that the table has are not measured again. With --quick the repository's own lights and formulas replace the data.
P4 measures DATA/real and, where it exists, DATA/real_bodies.
"""

import argparse
import time
from pathlib import Path

from crfnet_core.errors import CRFNetError
from crfnet_core.network import DEFAULT_MODEL
from training.evaluation.models import Model
from training.evaluation.protocols import PROTOCOLS, Evaluation, evaluate
from training.evaluation.test_sets import bundled_test_set, dorf_test_set

#: The protocols of --quick; the most photographs of P0 and P2, and of the protocol paper under each condition: of the
#: data, where 4020 are every response with every test scene, and with --quick.
QUICK_PROTOCOLS, COUNTS, QUICK_COUNTS = ("p0", "paper"), (4020, 200), (40, 5)


def parsed(arguments: list[str] | None = None) -> Evaluation:
    """Return what a command line asks for; CRFNetError without data or --quick, or if a model or number is wrong."""
    command = argparse.ArgumentParser(
        prog="python -m training.evaluation", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    command.add_argument("--data", type=Path, help="folder with dorf, linear, real and perhaps real_bodies")
    command.add_argument("--out", type=Path, required=True, help="folder of the table and the report")
    command.add_argument(
        "--model", nargs="+", default=[DEFAULT_MODEL.name], help="names in crfnet_core/models, or model folders"
    )
    command.add_argument("--protocol", nargs="+", choices=PROTOCOLS, help="all that the models allow by default")
    command.add_argument("--photographs", type=int, help="the most photographs of P0 and P2 (all, or 40 with --quick)")
    command.add_argument("--workers", type=int, default=2, help="processes")
    command.add_argument("--quick", action="store_true", help="bundled lights and formulas instead of the data")
    options = command.parse_args(arguments)
    if options.data is None and not options.quick:
        raise CRFNetError("there is nothing to measure on; give --data, or --quick for the bundled lights")
    if options.workers < 1:
        raise CRFNetError(f"the number of workers must be 1 or more, found {options.workers}; correct --workers")
    test_set = bundled_test_set() if options.quick else dorf_test_set(options.data)
    models = tuple(Model.find(name) for name in options.model)
    possible = [name for name in PROTOCOLS if name != "p2" or all(each.lacks(test_set.held_out) for each in models)]
    photographs, stressed = QUICK_COUNTS if options.quick else COUNTS
    return Evaluation(
        out=options.out,
        test_set=test_set,
        models=models,
        protocols=options.protocol or (QUICK_PROTOCOLS if options.quick else possible),
        photographs=photographs if options.photographs is None else options.photographs,
        stressed=stressed,
        workers=options.workers,
    )


def main(arguments: list[str] | None = None) -> None:
    """Measure, and print where the report is."""
    started = time.monotonic()
    try:
        evaluation = parsed(arguments)
        evaluate(evaluation)
    except CRFNetError as problem:
        raise SystemExit(str(problem)) from None
    print(f"wrote {evaluation.out / 'report.md'} in {time.monotonic() - started:.0f} s")


if __name__ == "__main__":
    main()
