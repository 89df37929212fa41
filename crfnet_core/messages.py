"""Every sentence that the errors and notices of `crfnet_core` say, each once, by its code.

A sentence says what was found, what was needed and what to do, on one line, in the terms of the library: it names no
option of the command and no button of Blender. Names in braces are the facts of the case.
"""

from collections.abc import Mapping

SENTENCES: Mapping[str, str] = {
    # library
    "bad_camera_name": "{name!r} cannot name a camera; it takes 1 to 60 letters, digits, spaces and signs of '.,+()-_,"
    " a letter or a digit first",
    "camera_exists": "{folder} has a camera {name!r} already",
    "camera_folder": "{folder}: cannot be made ({reason}); set {variable} to another folder",
    "camera_not_measured": "{path}: holds no measured response; measure the camera, or remove the file",
    "camera_not_removed": "{path}: cannot be removed ({reason})",
    "camera_version": "{path}: has camera_version {version}, needed is {needed}; update this program",
    "damaged_calibration": "{path}: is damaged ({reason}); calibrate again",
    "damaged_camera": "{path}: is damaged ({reason}); restore or remove it",
    "no_camera": "there is no camera {name!r} in {folder}",
    "not_a_calibration": "{path}: is not the JSON file of a calibration; calibrate the camera first",
    "not_a_camera": "{path}: is not the JSON file of a camera; restore or remove it",
    "other_camera": "the photograph is of {other}, but {name!r} is {camera}",
    "unreadable_camera": "{path}: cannot be read ({reason}); check its name",
}
