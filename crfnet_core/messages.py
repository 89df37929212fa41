"""Every sentence that the errors and notices of `crfnet_core` say, each once, by its code.

A sentence says what was found, what was needed and what to do, on one line, in the terms of the library: it names no
option of the command and no button of Blender. Names in braces are the facts of the case.
"""

from collections.abc import Mapping

SENTENCES: Mapping[str, str] = {
    # files
    "exists": "{path}: exists already; choose another name or ask to overwrite it",
    "folder_absent": "{path}: the folder {folder} does not exist; create it first",
    "folder_read_only": "{path}: the folder {folder} is not writable; choose another",
    "is_folder": "{path}: is a folder; give the name of a file",
    "not_written": "{path}: cannot be written ({reason})",
    # response
    "brightness_codes": "found values up to {found:g}, but brightness and irradiance lie in [0, 1]: divide code values"
    " by the largest code, such as 255",
    "curve_dark": "a response must be brighter at full irradiance than in the dark",
    "curve_exponent": "a gamma must be above 0, found {exponent}",
    "curve_not_strict": "a response must increase strictly from 0 to 1; use from_samples",
    "curve_samples": "a response needs a row of two or more finite samples",
    "curve_shape": "a response needs shape ({samples},), found {shape}; use from_samples",
}
