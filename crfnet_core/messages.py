"""Every sentence that the errors and notices of `crfnet_core` say, each once, by its code.

A sentence says what was found, what was needed and what to do, on one line, in the terms of the library: it names no
option of the command and no button of Blender. Names in braces are the facts of the case.
"""

from collections.abc import Mapping

SENTENCES: Mapping[str, str] = {
    # estimate: errors
    "damaged_estimate": "the document of an estimate is damaged ({problem})",
    "estimate_lacks": "the document of an estimate lacks {entry}; write it again",
    "in_file": "{path}: {problem}",
    "list_of_estimates": "this document holds a list of estimates; give document['estimates'][0]",
    "no_photographs": "there is no photograph to analyze; give at least one",
    "not_a_device": "{device} is not a device; give one of Device: {names}",
    "not_a_photo": "a {kind} is not a Photo; read_photo makes one from a file, Photo.from_array from an array",
    "not_a_prior": "a {kind} is not a Prior; Prior.load makes one from a name or a file",
    "not_an_estimate": "this is not a document of an estimate: it lacks 'schema_version'",
    "other_schema": "the estimate has schema_version {found}, this version reads {known}: update it",
    # estimate: warnings; where JSON has them, their text does not change
    "as_written": "{text}",
    "camera_disagrees": "the photograph's own estimate is {stops:.2f} stop and E_est {error:.2f} away from the response"
    " of {camera}, more than usual: look whether its picture mode is the same",
    "clipped": "mostly clipped: the answer is little more than the mean of cameras, so take one with another exposure",
    "developed": "developed from a raw file by {editor}, and not by the camera: give the camera's own file, or develop"
    " the raw file to linear light, which needs no estimate",
    "edited": "saved by {editor}, which may have changed the tones: give the camera's own file",
    "gray": "gray photograph: one channel says less than three, and it may be a mixture of channels",
    "narrow_range": "no window covers the range of brightness: expect a poor estimate",
    "other_camera": "the photograph is of {other}, but {name!r} is {camera}",
    "recognized": "{reason}",
    "several_cameras": "photographs of different cameras ({cameras}): estimate each camera by itself",
}
