"""`crfnet camera`: the responses of cameras, kept to be used again."""

from __future__ import annotations

import argparse
from collections.abc import Callable

from crfnet_core.errors import CameraError
from crfnet_core.files import atomic_write_text, json_text
from crfnet_core.library import (
    Camera,
    CameraLibrary,
    add_measured,
    add_photographs,
    camera_document,
    camera_estimate,
    differences,
    find_camera,
    read_calibration,
    remove_photographs,
)
from crfnet_core.network import ResponseNetwork

from ... import pipeline, report
from ...interchange.files import write_response
from ..remedies import CommandError
from .printing import print_json, print_lines, progress_bar


def run(arguments: argparse.Namespace) -> None:
    """Do what `crfnet camera add`, `list`, `show`, `remove` or `export` asks for."""
    actions: dict[str, Callable[[argparse.Namespace], None]] = {
        "add": _add,
        "list": _list,
        "show": _show,
        "remove": _remove,
        "export": _export,
    }
    actions[arguments.action](arguments)


def _add(arguments: argparse.Namespace) -> None:
    """Add photographs or a measured response to a camera."""
    photos, calibration = arguments.photos, arguments.from_calibration
    if bool(photos) == bool(calibration):
        raise CommandError("photographs_or_calibration")
    library = CameraLibrary.of_user()
    if calibration:
        measured = read_calibration(calibration)
        camera = add_measured(library, arguments.name, measured, overwrite=arguments.overwrite)
        notes = []
    else:
        network = ResponseNetwork.load(arguments.model)
        with progress_bar("photographs") as progress:
            done = add_photographs(library, arguments.name, photos, network=network, progress=progress)
        camera = done.camera
        notes = [f"{photograph.name} is there already and counts once." for photograph in done.known]
    if not arguments.json:
        print_lines([f"Kept in {library.folder}.", *notes])
    _print_camera(camera, arguments)


def _list(arguments: argparse.Namespace) -> None:
    """List the user's cameras, and those that come with this project."""
    own, shipped = CameraLibrary.of_user(), CameraLibrary.shipped()
    if arguments.json:
        summaries = {
            name: list(map(report.camera_summary, library.cameras()))
            for name, library in (("cameras", own), ("shipped", shipped))
        }
        print_json({"folder": str(own.folder), **summaries, "problems": own.problems()})
        return
    print_lines([f"Yours, in {own.folder}:", *_indented(own)])
    print_lines(["Measured, with crfnet:", *_indented(shipped)])
    print_lines(f"note: {problem}" for problem in own.problems())


def _show(arguments: argparse.Namespace) -> None:
    """Show what is known of a camera."""
    _print_camera(find_camera(arguments.name), arguments)


def _remove(arguments: argparse.Namespace) -> None:
    """Remove a camera, or photographs of it."""
    library, name = CameraLibrary.of_user(), arguments.name
    if arguments.photos:
        left = report.camera_summary(remove_photographs(library, name, arguments.photos))
    else:
        library.get(name)  # a wrong name makes no folder
        with library.locked():
            library.remove(name)
        left = None
    if arguments.json:
        print_json({"folder": str(library.folder), "removed": arguments.photos or [name], "camera": left})
    else:
        print_lines(
            [f"Removed: {', '.join(arguments.photos or [name])}.", *([f"Now {left['basis']}."] if left else [])]
        )


def _export(arguments: argparse.Namespace) -> None:
    """Write the response of a camera as a LUT, for another program, or as the library keeps it."""
    camera, out = find_camera(arguments.name), arguments.out
    notes: tuple[str, ...] = ()
    if out.suffix.lower() == ".json":
        atomic_write_text(out, json_text(camera_document(camera)), overwrite=arguments.overwrite, error=CameraError)
    else:
        lut = pipeline.response_lut(camera_estimate(camera, model=pipeline.model_label(arguments.model)))
        notes = write_response(out, lut, overwrite=arguments.overwrite)
    if arguments.json:
        print_json({"camera": camera.name, "written": str(out), "notes": notes})
    else:
        print_lines([*(f"{note}." for note in notes), f"Written: {out}."])


def _print_camera(camera: Camera, arguments: argparse.Namespace) -> None:
    """Print how good a camera's response is, its photographs, and which of them disagree."""
    model = pipeline.model_label(arguments.model)
    estimate, found = camera_estimate(camera, model=model), differences(camera, model=model)
    if arguments.json:
        photographs = report.photograph_documents(camera, found)
        print_json(report.camera_summary(camera) | {"photographs": photographs, "estimate": estimate.to_dict()})
        return
    print_lines([report.camera_line(camera), *report.photograph_lines(camera, found, model=model)])
    print_lines([*report.verdict_lines(estimate), *report.disagreement_lines(camera, found)])


def _indented(library: CameraLibrary) -> list[str]:
    """Return the cameras of a library, one line each."""
    return [f"  {report.camera_line(camera)}" for camera in library.cameras()] or ["  none"]
