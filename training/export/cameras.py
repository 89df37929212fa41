"""The library of measured cameras that comes with the product: ``python -m training.export.cameras DATA``.

It is made of the measured responses of DATA/real_bodies: measurements, no photographs. Left out are stacks that a
program developed or edited, because their response is the program's; those of grade C, which are off by a stop and more
beside white; and bodies of unknown make and model, which no photograph could match. Two stacks of a body are taken
for one setting of it unless their responses differ by more than `SAME_SETTING` standard deviations: then it has an
entry for each setting, since no file says in which picture mode it was taken. Of each setting the most certain stack
is kept.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from crfnet_core.cameras import Camera, CameraLibrary, CameraSettings, MeasuredResponse
from crfnet_core.cameras.answer import brightness_per_stop
from crfnet_core.metrics import estimation_error
from crfnet_core.response import ResponseCurve
from training.data.real.case_metadata import metadata_of_case
from training.data.real.file_origin import Editing, editing
from training.data.real.photographs import CAUTION, REAL_BODIES, TRUSTED_GRADES, USED, case_rows, read_measured

#: Standard deviation of the shape of the measured responses of DATA/real_bodies, in stops, as its README states it.
SHAPE_STOPS = 0.05

#: Two stacks are of one setting if the E_est between them is at most so many times the one expected of both.
SAME_SETTING = 2.0

#: How the names of bodies begin whose make and model nobody knows.
UNKNOWN_BODY = "unknown"

#: Decimals of the responses: their least step is 1e-7.
DECIMALS = 8


@dataclass(frozen=True)
class Stack:
    """A measured exposure stack.

    Parameters
    ----------
    settings : CameraSettings
        What its files say.
    curve : ResponseCurve
        Its response.
    error : float
        Standard deviation of its E_est.
    frames : int
        How many frames it has.
    grade : str
        A or B.
    caution : str
        Why it is less certain, or nothing.
    """

    settings: CameraSettings
    curve: ResponseCurve
    error: float
    frames: int
    grade: str
    caution: str

    def is_like(self, other: Stack) -> bool:
        """Return whether two stacks may be of one setting."""
        expected = float(np.hypot(self.error, other.error))
        return estimation_error(self.curve, other.curve) <= SAME_SETTING * expected

    def measured(self, stacks: int, iso: Sequence[int]) -> MeasuredResponse:
        """Return the response as the library keeps it, the best of so many stacks at these sensitivities."""
        total = self.error / float(np.linalg.norm(brightness_per_stop(self.curve)))
        shape = min(SHAPE_STOPS, total)
        best = f", the best of {stacks} stacks" if stacks > 1 else ""
        return MeasuredResponse(
            curve=ResponseCurve(self.curve.brightness.round(DECIMALS)),
            shape_stops=round(shape, 3),
            scale_stops=round(float(np.sqrt(total**2 - shape**2)), 3),
            source=f"{self.frames} exposures (grade {self.grade}{best})",
            settings=CameraSettings(self.settings.make, self.settings.model, self.settings.software, tuple(iso)),
            warnings=(f"measured with caution: {self.caution}",) if self.caution else (),
        )


def measured_cameras(data: Path) -> list[Camera]:
    """Return the cameras of DATA/real_bodies, sorted by name.

    Parameters
    ----------
    data : Path
        The data folder.
    """
    folder = data / REAL_BODIES
    stacks = {row["stack"]: _stack(folder, row) for row in case_rows(folder) if _is_taken(row)}
    names = sorted({stack.settings.camera for stack in stacks.values()})
    return [
        camera
        for name in names
        for camera in _cameras(name, [stack for stack in stacks.values() if stack.settings.camera == name])
    ]


def _is_taken(row: Mapping[str, str]) -> bool:
    """Return whether the stack of a row is one of the library: see the head of this module."""
    is_edited = editing(row["exif_software"], use=row["use"]) is Editing.EDITED
    is_known = not row["body"].startswith(UNKNOWN_BODY)
    return is_known and row["grade"] in TRUSTED_GRADES and not is_edited


def _stack(folder: Path, row: Mapping[str, str]) -> Stack:
    """Return the stack of a row."""
    settings = CameraSettings.of(metadata_of_case(row))
    return Stack(
        settings=settings if settings.camera else replace(settings, model=row["body"]),
        curve=read_measured(folder / row["gt"]),
        error=float(row["uncertainty_L2"]),
        frames=int(row["n_frames"]),
        grade=row["grade"],
        caution="" if row["use"] == USED else row["use"].removeprefix(CAUTION),
    )


def _cameras(name: str, stacks: list[Stack]) -> list[Camera]:
    """Return the settings of a body, each by its most certain stack."""
    groups: list[list[Stack]] = []
    for stack in sorted(stacks, key=lambda stack: stack.error):
        like = next((group for group in groups if group[0].is_like(stack)), None)
        if like is None:
            groups.append([stack])
        else:
            like.append(stack)
    return [
        Camera(
            name=name if len(groups) == 1 else f"{name} ({number})",
            measured=group[0].measured(len(group), sorted({iso for stack in group for iso in stack.settings.iso})),
        )
        for number, group in enumerate(groups, 1)
    ]


def main(argv: Sequence[str] | None = None) -> int:
    """Write the library anew."""
    parser = argparse.ArgumentParser(prog="training.export.cameras", description="Write the library of cameras.")
    parser.add_argument("data", type=Path, help="the data folder, with real_bodies")
    data = parser.parse_args(argv).data
    library = CameraLibrary.shipped()
    for camera in library.cameras():
        library.remove(camera.name)
    library.folder.mkdir(exist_ok=True)
    for camera in measured_cameras(data):
        print(library.save(camera).name, camera.basis)
    return 0


if __name__ == "__main__":
    sys.exit(main())
