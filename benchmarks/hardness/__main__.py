"""Run everything, and write the results: see `benchmarks.hardness`."""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator
from pathlib import Path

from benchmarks.hardness.disk_full import fill
from benchmarks.hardness.fuzz import fuzz
from benchmarks.hardness.kills import kill
from benchmarks.hardness.pairs import pair
from benchmarks.hardness.soak import soak
from benchmarks.hardness.table import publish, results, state
from benchmarks.hardness.trial import Row, make_trials


def rows(options: argparse.Namespace, work: Path) -> Iterator[Row]:
    """Yield every row as it is done."""
    trials = make_trials(work)
    if options.kills:
        yield from kill(trials, options.kills, work)
    if options.pairs:
        yield from pair(trials, options.pairs, work)
    if options.full:
        yield from fill(trials, options.full, work)
    if options.soak:
        yield soak(options.soak, work)
    if options.fuzz:
        yield from fuzz(options.fuzz, work)


def main() -> None:
    """Parse the sizes, run, print and publish; a size of 0 leaves a part out."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.hardness", description="Try to break the command.")
    parser.add_argument("--kills", type=int, default=10, help="runs per signal and subcommand")
    parser.add_argument("--pairs", type=int, default=5, help="pairs of runs per subcommand")
    parser.add_argument("--full", type=int, default=10, help="runs without room per subcommand and way")
    parser.add_argument("--soak", type=int, default=200, help="estimates in one process")
    parser.add_argument("--fuzz", type=float, default=3600, help="seconds of fuzzing")
    options = parser.parse_args()
    done, code = [], state()
    with tempfile.TemporaryDirectory() as folder:
        for row in rows(options, Path(folder)):
            print(
                f"{row.what}: {row.cases} cases, {len(row.failures)} failures {row.note} {list(row.failures[:3])}",
                flush=True,
            )
            done.append(row)
    publish(results(done, code))


if __name__ == "__main__":
    main()
