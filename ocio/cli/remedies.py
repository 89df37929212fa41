"""The command's own words about errors: what to do with its options, and errors of the options themselves.

The libraries' sentences (`crfnet_core.messages`, `crfnet.messages`) name no option. `explained` adds the remedy.
"""

from collections.abc import Mapping

from crfnet_core.errors import CRFNetError

from ..messages import NOT_TEXT

#: Code of an error -> what the user can do with an option, behind "; " at the end of its sentence.
REMEDIES: Mapping[str, str] = {
    # calibration
    **dict.fromkeys(("exposures_gap", "exposures_span"), "--times states them in place of EXIF"),
    "frame_edited": "or add --accept-edited to measure the response of that program",
    "frame_mistimed": "--times states the times in place of EXIF",
    "frame_untimed": "add --times 1/60,1/30,...",
    # library
    "camera_exists": "give another name with --name, or --overwrite to replace it",
    "no_camera": "crfnet camera list shows them",
    # movies and plates
    "exr_untagged": "add --encoded",
    **dict.fromkeys(("finished_differs", "finished_foreign", "finished_outdated"), "or add --overwrite"),
    "primaries_differ": "or give them with --primaries",
    "primaries_unknown": "give them with --primaries",
    "single_file": "leave --frames out",
    # photograph
    **dict.fromkeys(("tagged_color_space", "tagged_encoding", "tagged_linear"), "--ignore-metadata does so"),
    # pipeline
    **dict.fromkeys(("file_exists", "files_exist", "other_options"), "or add --overwrite"),
    "folder_for_photograph": "or add --each for every photograph in it",
    "movie_in_batch": "leave --each out",
    "one_name": "or add --no-linear",
    "process_died": "finished photographs are kept, and --workers limits the processes",
}

#: The sentences of `CommandError`, by code.
SENTENCES: Mapping[str, str] = {
    "each_option_alone": "--{name} is for --each, one response for each photograph; add it, or drop --{name}",
    "frames_of_each": "--frames chooses the frames of one response, --each takes photographs; drop one",
    "name_not_unicode": f"{{name}}: the name {NOT_TEXT}",
    "packaged_camera": "{name!r} is a packaged camera, which cannot be removed",
    "pattern_for_file": "{path}: stands for the frames of a sequence, but {plate} is a single file; give its sequence,"
    " such as shot.%04d.png, or a name without a placeholder",
    "several_plates": "{count} plates are given, one is needed; write a sequence as shot.%04d.png, or add --each",
    "times_of_raw_files": "--times is for the frames of a stack; raw files need no times, so drop it",
    "two_responses": "--lut and --camera both name a response; give one of them",
}


class CommandError(CRFNetError):
    """Options that do not go together."""

    sentences = SENTENCES


def explained(problem: CRFNetError) -> str:
    """Return an error's sentence with the command's remedy, if there is one."""
    remedy = REMEDIES.get(problem.code)
    return f"{problem}; {remedy}" if remedy else str(problem)
