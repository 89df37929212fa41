"""What a library of cameras is worth, on real photographs: ``python -m training.evaluation.cameras DATA``.

Three tables: the errors of 1, 2 and 4 photographs of one camera together; those of a response that was measured on
another stack of the same camera, beside the estimate from a photograph; and how often a photograph disagrees with its
own camera and with another one. The photographs are those of the stacks that `training.data.real.stacks` takes. The
bank of an estimate knows nothing of the bodies of its fold; a stored camera is read as the product reads it.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations, permutations
from pathlib import Path

import numpy as np

from crfnet_core.estimate.analysis import analyze_photographs
from crfnet_core.estimate.estimate import estimate_from_evidence
from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.library import Camera, CameraSettings, KeptPhotograph, compared
from crfnet_core.network import ResponseNetwork
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import estimation_error, shape_error
from training.data.real.photographs import REAL_BODIES, RealPhotograph, real_photographs
from training.data.real.stacks import Stack, measured_response, settings_of_bodies
from training.evaluation.measure.real import bank_without_fold, read_real_photo
from training.evaluation.report.markdown_tables import rows_of

#: Numbers of photographs that are given together.
COUNTS = (1, 2, 4)

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
    kept : KeptPhotograph
        What the library keeps of it.
    own : ResponseEstimate
        What is estimated from it alone, out of fold.
    """

    case: RealPhotograph
    stack: Stack
    kept: KeptPhotograph
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


def accumulated(setting: Setting, count: int, data: Path) -> Errors:
    """Return the mean errors of `count` photographs of a setting together, of as many stacks as can be."""
    choices = list(combinations(setting.photographs, count))
    numbers = [len({one.stack.measured for one in choice}) for choice in choices]
    spread = [choice for choice, number in zip(choices, numbers, strict=True) if number == max(numbers)]
    return _mean(_errors(one.stack.curve, _together(choice, data).curve) for choice in spread for one in choice)


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


def disagreements(settings: Sequence[Setting], camera_of: Callable[[Setting, Stack | None], Camera | None]) -> Errors:
    """Return the fraction of photographs that disagree with their own camera, and with those of other bodies.

    Parameters
    ----------
    settings : sequence of Setting
        All settings.
    camera_of : callable
        Called with a setting and the stack that a photograph is of, which is None for photographs of other bodies;
        returns the camera to compare with, or None if there is none.
    """
    own, other = [], []
    for setting in settings:
        for photograph in setting.photographs:
            if camera := camera_of(setting, photograph.stack):
                own.append(not compared(photograph.own, camera).agrees)
    for one, another in permutations(settings, 2):
        if one.body != another.body and (camera := camera_of(another, None)):
            other += [not compared(photograph.own, camera).agrees for photograph in one.photographs]
    return float(np.mean(own)), float(np.mean(other))


def measured_camera(setting: Setting, stack: Stack | None) -> Camera:
    """Return a setting as the shipped library keeps it, or by the photograph's own stack."""
    return Camera(setting.name, measured=measured_response([stack] if stack else setting.stacks))


def photographed_camera(setting: Setting, stack: Stack | None) -> Camera | None:
    """Return a setting by its photographs, without those of a photograph's own stack; None if there is no other."""
    kept = tuple(one.kept for one in setting.photographs if one.stack is not stack)
    return Camera(setting.name, photographs=kept) if kept else None


def _read(case: RealPhotograph, stack: Stack, data: Path, network: ResponseNetwork) -> ReadPhotograph:
    """Return what the network reads in a photograph."""
    label, photo = network.config.label, read_real_photo(case)
    (analyzed,) = analyze_photographs(photo, network=network)
    own = estimate_from_evidence([analyzed], model=label, bank=bank_without_fold(case, data))
    return ReadPhotograph(
        case, stack, KeptPhotograph(case.name, label, CameraSettings.of(photo.metadata), analyzed), own
    )


def _together(photographs: Sequence[ReadPhotograph], data: Path) -> ResponseEstimate:
    """Return what is estimated from photographs of one body together, out of fold."""
    first = photographs[0]
    analyzed = [one.kept.analyzed for one in photographs]
    return estimate_from_evidence(analyzed, model=first.kept.model, bank=bank_without_fold(first.case, data))


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


def report(settings: Sequence[Setting], data: Path) -> str:
    """Return the tables."""
    enough = [setting for setting in settings if len(setting.photographs) >= max(COUNTS)]
    rows = {setting.name: [accumulated(setting, count, data) for count in COUNTS] for setting in enough}
    rows["mean"] = [_mean(column) for column in zip(*rows.values(), strict=True)]
    parts = [rows_of(["camera", *map(str, COUNTS)], ([name, *map(_words, row)] for name, row in rows.items()))]

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
    parts.append(rows_of(["camera", "measured on another stack", "estimate of a photograph"], table))

    kinds = {"measured": measured_camera, "photographs of other stacks": photographed_camera}
    fractions = {name: disagreements(settings, camera_of) for name, camera_of in kinds.items()}
    cells = ([name, *(f"{100 * fraction:.0f} %" for fraction in both)] for name, both in fractions.items())
    parts.append(rows_of(["camera by", "disagree with their own", "disagree with another body"], cells))
    return "\n".join(parts)


def main(argv: Sequence[str] | None = None) -> int:
    """Print the tables."""
    parser = argparse.ArgumentParser(prog="training.evaluation.cameras", description="Measure the library of cameras.")
    parser.add_argument("data", type=Path, help="the data folder, with real_bodies")
    data = parser.parse_args(argv).data
    print(report(read_settings(data, ResponseNetwork.load()), data), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
