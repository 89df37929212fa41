"""The library of measured cameras that comes with the product: ``python -m training.export.cameras DATA``.

It is made of the measured responses of DATA/real_bodies: measurements, no photographs. Left out are stacks that a
program developed or edited, since their response is the program's; stacks of grade C, whose scale is off by half a
stop; and bodies of unknown make and model. No file says in which picture mode it was taken: two stacks of a body are
taken for one setting of it unless their responses differ by more than `SAME_SETTING` standard deviations. A body has an
entry for each setting, by the most certain stack. One more is measured here, as `crfnet calibrate` does, on the raw
files in DATA/raw_pairs.
"""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

import numpy as np

from crfnet_core.calibration import PairCalibration, calibrate_pairs
from crfnet_core.library import Camera, CameraLibrary, CameraSettings
from crfnet_core.library.answer import brightness_per_stop
from crfnet_core.photograph.metadata.editors import is_editor
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import estimation_error
from training.data.in_camera import log_irradiance, response_of
from training.data.real_photographs import REAL_BODIES, TRUSTED_GRADES, caution, metadata_of_case, read_measured
from training.data.scenes import table_rows

#: Two stacks are of one setting if the E_est between them is at most so many times the one expected of both.
SAME_SETTING = 2.0

#: Standard deviation of the shape of the measured responses of DATA/real_bodies, in stops, as its README states it.
SHAPE_STOPS = 0.05

DECIMALS = 8  # decimals of the responses: their least step is 1e-7
RAW_PAIRS = "raw_pairs"  # the folder of raw files with their JPEGs, all of one body
UNKNOWN_BODY = "unknown"  # how the names of bodies begin whose make and model nobody knows

#: Words in `use` of DATA/real_bodies for a file that its publisher developed or edited.
DEVELOPED = "edited/developed by software"


@dataclass(frozen=True)
class Stack:
    """A measured exposure stack."""

    settings: CameraSettings  # the camera and its settings, as the files state them
    curve: ResponseCurve
    error: float  # standard deviation of its E_est
    frames: str  # number of exposures, or nothing where the list has none
    caution: str  # why it is less certain, or nothing

    def is_like(self, other: Self) -> bool:
        """Return whether two stacks may be of one setting."""
        expected = float(np.hypot(self.error, other.error))
        return estimation_error(self.curve, other.curve) <= SAME_SETTING * expected


def measured_cameras(data: Path) -> list[Camera]:
    """Return the cameras of DATA/real_bodies, sorted by name, and the one of DATA/raw_pairs if it is there."""
    folder = data / REAL_BODIES
    stacks = {row["stack"]: _stack(folder, row) for row in table_rows(folder / "cases.csv") if _is_taken(row)}
    bodies: dict[str, list[list[Stack]]] = {}
    for stack in sorted(stacks.values(), key=lambda stack: (stack.settings.camera, stack.error)):
        settings = bodies.setdefault(stack.settings.camera, [])
        like = next((others for others in settings if others[0].is_like(stack)), None)
        if like is None:
            settings.append([stack])
        else:
            like.append(stack)
    cameras = [
        measured_camera(body if len(settings) == 1 else f"{body} ({number})", stacks)
        for body, settings in bodies.items()
        for number, stacks in enumerate(settings, 1)
    ]
    raw_files = data / RAW_PAIRS
    return [*cameras, raw_camera(calibrate_pairs([raw_files]))] if raw_files.is_dir() else cameras


def measured_camera(name: str, stacks: Sequence[Stack]) -> Camera:
    """Return the camera of a setting: the response of its first stack, smoothed, with the sensitivities of all.

    Without smoothing, its slope in stops changes within a code by up to eleven times near white: the plate gets bands.
    """
    first = stacks[0]
    total = first.error / float(np.linalg.norm(brightness_per_stop(first.curve)))
    shape = min(SHAPE_STOPS, total)
    best = f" (the best of {len(stacks)} stacks)" if len(stacks) > 1 else ""
    frames = f"{first.frames} exposures" if first.frames else "an exposure stack"
    iso = tuple(sorted({iso for stack in stacks for iso in stack.settings.iso}))
    return Camera(
        name=name,
        curve=_smoothed(first.curve),
        shape_stops=round(shape, 3),
        scale_stops=round(float(np.sqrt(total**2 - shape**2)), 3),
        source=frames + best,
        settings=CameraSettings(first.settings.make, first.settings.model, first.settings.software, iso),
        warnings=(f"measured with caution: {first.caution}",) if first.caution else (),
    )


def raw_camera(found: PairCalibration) -> Camera:
    """Return the camera that was measured from raw files and their JPEGs, smoothed as stacks are."""
    iso = tuple(sorted({shot.iso for shot in found.shots if shot.iso}))
    settings = replace(CameraSettings.from_metadata(found.metadata), iso=iso)
    return Camera(
        name=settings.camera,
        curve=_smoothed(found.curve),
        shape_stops=round(found.uncertainty.shape_stops, 3),
        scale_stops=round(found.uncertainty.scale_stops, 3),
        source=f"{len(found.shots)} raw files (white by {found.white_basis})",
        settings=settings,
        warnings=tuple(map(str, found.warnings)),
    )


def _smoothed(curve: ResponseCurve) -> ResponseCurve:
    """Return a measured response without the steps within a code, which would give bands to a plate."""
    return ResponseCurve(response_of(log_irradiance(curve)).round(DECIMALS))


def _is_taken(row: Mapping[str, str]) -> bool:
    """Return whether the stack of a row is one of the library: see the head of the module."""
    is_edited = DEVELOPED in row["use"] or is_editor(row["exif_software"])
    return row["grade"] in TRUSTED_GRADES and not is_edited and not row["body"].startswith(UNKNOWN_BODY)


def _stack(folder: Path, row: Mapping[str, str]) -> Stack:
    """Return the stack of a row."""
    settings = CameraSettings.from_metadata(metadata_of_case(row))
    return Stack(
        settings=settings if settings.camera else replace(settings, model=row["body"]),
        curve=read_measured(folder / row["gt"]),
        error=float(row["uncertainty_L2"]),
        frames=row["n_frames"],
        caution=caution(row),
    )


def main() -> None:
    """Write the library anew."""
    parser = argparse.ArgumentParser(description="Write the library of cameras.")
    parser.add_argument("data", type=Path, help="the data folder, with real_bodies")
    cameras = measured_cameras(parser.parse_args().data)
    library = CameraLibrary.shipped()
    for camera in library.cameras():
        library.remove(camera.name)
    for camera in cameras:
        print(library.save(camera).name, camera.basis)


if __name__ == "__main__":
    main()
