"""`crfnet camera`: measured responses of cameras, kept to be used again."""

import argparse

from crfnet_core.errors import CameraError
from crfnet_core.files import atomic_write_text, json_text
from crfnet_core.library import Camera, CameraLibrary, camera_document, camera_estimate, find_camera, read_calibration

from ... import pipeline
from ...luts.files import write_lut
from ...report import words
from ...report.documents import camera_summary
from ..remedies import CommandError
from .printing import print_result


def run(arguments: argparse.Namespace) -> None:
    """Run `crfnet camera add`, `list`, `show`, `remove` or `export`."""
    actions = {"add": _add, "list": _list, "show": _show, "remove": _remove, "export": _export}
    actions[arguments.action](arguments)


def _add(arguments: argparse.Namespace) -> None:
    """Keep the measured response of a calibration."""
    camera = read_calibration(arguments.from_calibration, arguments.name)
    path = CameraLibrary.of_user().save(camera, overwrite=arguments.overwrite)
    _print_camera(camera, f"Written: {path}.", as_json=arguments.json)


def _list(arguments: argparse.Namespace) -> None:
    user, shipped = CameraLibrary.of_user(), CameraLibrary.shipped()
    cameras, others = (list(map(camera_summary, library.cameras())) for library in (user, shipped))
    document = {"folder": str(user.folder), "cameras": cameras, "shipped": others, "problems": user.problems()}
    lines = [
        f"Your cameras, in {user.folder}:",
        *_indented(user),
        "Packaged cameras:",
        *_indented(shipped),
        *(f"note: {problem}" for problem in user.problems()),
    ]
    print_result(document, lines, as_json=arguments.json)


def _show(arguments: argparse.Namespace) -> None:
    _print_camera(find_camera(arguments.name), as_json=arguments.json)


def _remove(arguments: argparse.Namespace) -> None:
    library = CameraLibrary.of_user()
    if not library.file_of(arguments.name) and CameraLibrary.shipped().file_of(arguments.name):
        raise CommandError("packaged_camera", name=arguments.name)
    library.remove(arguments.name)
    document = {"folder": str(library.folder), "removed": arguments.name}
    print_result(document, [f"Removed: {arguments.name}."], as_json=arguments.json)


def _export(arguments: argparse.Namespace) -> None:
    """Write the response of a camera as a LUT, or as the library keeps it."""
    camera, out = find_camera(arguments.name), arguments.out
    if out.suffix.lower() == ".json":
        atomic_write_text(out, json_text(camera_document(camera)), overwrite=arguments.overwrite, error=CameraError)
    else:
        write_lut(out, pipeline.response_lut(camera_estimate(camera)), overwrite=arguments.overwrite)
    print_result({"camera": camera.name, "written": str(out)}, [f"Written: {out}."], as_json=arguments.json)


def _print_camera(camera: Camera, *first: str, as_json: bool) -> None:
    """Print first lines, a camera, and how good its response is."""
    estimate = camera_estimate(camera)
    document = camera_summary(camera) | {"estimate": estimate.to_dict()}
    print_result(document, [*first, words.camera_line(camera), *words.verdict_lines(estimate)], as_json=as_json)


def _indented(library: CameraLibrary) -> list[str]:
    """Return the cameras of a library, one line each."""
    return [f"  {words.camera_line(camera)}" for camera in library.cameras()] or ["  none"]
