"""How good a measured camera is on another stack: ``python -m training.evaluation.cameras DATA``.

One table: the errors of a response that was measured on another stack of the same camera, and of the estimate from a
photograph. The photographs belong to the stacks that `training.data.real.stacks` takes. The bank of an estimate knows
nothing of the bodies of its fold.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import permutations
from pathlib import Path

import numpy as np

from crfnet_core.estimate.analysis import analyze_photographs
from crfnet_core.estimate.estimate import ResponseEstimate, estimate_of
from crfnet_core.network import ResponseNetwork
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import estimation_error, shape_error
from training.data.real.photographs import REAL_BODIES, RealPhotograph, real_photographs
from training.data.real.stacks import Stack, settings_of_bodies
from training.evaluation.measure.real import bank_without_fold, read_real_photo
from training.evaluation.report.markdown_tables import rows_of

#: E_est and shape error in stops.
Errors = tuple[float, float]


@dataclass(frozen=True)
class ReadPhotograph:
    """A photograph of a measured stack, as the network reads it.

    Parameters
    ----------
    case : RealPhotograph
        The photograph.
    stack : Stack
        Its stack.
    own : ResponseEstimate
        What is estimated from it alone, out of fold.
    """

    case: RealPhotograph
    stack: Stack
    own: ResponseEstimate


@dataclass(frozen=True)
class Setting:
    """One setting of a body: its stacks and their photographs."""

    name: str
    body: str
    stacks: tuple[Stack, ...]
    photographs: tuple[ReadPhotograph, ...]


def read_settings(data: Path, network: ResponseNetwork) -> list[Setting]:
    """Return the settings of the bodies of DATA/real_bodies, with what the network reads in their photographs."""
    cases = real_photographs(data)[REAL_BODIES]
    found = []
    for body, settings in settings_of_bodies(data).items():
        for name, stacks in settings.items():
            files = {stack.measured: stack for stack in stacks}
            photographs = [_read(case, files[case.measured], data, network) for case in cases if case.measured in files]
            found.append(Setting(name, body, tuple(stacks), tuple(photographs)))
    return found


def of_another_stack(setting: Setting, stacks: Sequence[Stack]) -> tuple[Errors, Errors] | None:
    """Return the mean errors of the responses of other stacks on those of a setting, and those of the estimates.

    Parameters
    ----------
    setting : Setting
        Whose stacks and photographs are measured on.
    stacks : sequence of Stack
        Where the other responses come from. Without another stack the result is None.
    """
    pairs = [(one, other) for one in setting.stacks for other in stacks if one is not other]
    if not pairs:
        return None
    estimates = _mean(_errors(one.stack.curve, one.own.curve) for one in setting.photographs)
    return _mean(_errors(one.curve, other.curve) for one, other in pairs), estimates


def _read(case: RealPhotograph, stack: Stack, data: Path, network: ResponseNetwork) -> ReadPhotograph:
    """Return what the network reads in a photograph."""
    (analyzed,) = analyze_photographs(read_real_photo(case), network=network)
    own = estimate_of([analyzed], model=network.config.label, bank=bank_without_fold(case, data))
    return ReadPhotograph(case, stack, own)


def _errors(true: ResponseCurve, found: ResponseCurve) -> Errors:
    """Return E_est and the shape error in stops."""
    return estimation_error(true, found), shape_error(true, found)


def _mean(errors: Iterable[Errors]) -> Errors:
    """Return the means of both errors."""
    error, stops = np.mean(list(errors), axis=0)
    return float(error), float(stops)


def _words(errors: Errors) -> str:
    """Return both errors as a cell of a table."""
    return f"{errors[0]:.2f}, {errors[1]:.3f} stop"


def report(settings: Sequence[Setting]) -> str:
    """Return the table."""
    same = {one.name: of_another_stack(one, one.stacks) for one in settings}
    other = {
        f"{one.name} by {another.name}": of_another_stack(one, another.stacks)
        for one, another in permutations(settings, 2)
        if one.body == another.body
    }
    known = {name: errors for name, errors in same.items() if errors}
    known["mean"] = tuple(_mean(column) for column in zip(*known.values(), strict=True))  # type: ignore[assignment]
    known |= {name: errors for name, errors in other.items() if errors}
    table = ([name, *map(_words, errors)] for name, errors in known.items())
    return rows_of(["camera", "measured on another stack", "estimate of a photograph"], table)


def main(argv: Sequence[str] | None = None) -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(
        prog="training.evaluation.cameras", description="Measure how good measured cameras are."
    )
    parser.add_argument("data", type=Path, help="the data folder, with real_bodies")
    data = parser.parse_args(argv).data
    print(report(read_settings(data, ResponseNetwork.load())), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
