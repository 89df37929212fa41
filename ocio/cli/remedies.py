"""Remedies for errors that name an option of the command: the libraries' sentences name none."""

from collections.abc import Mapping

#: Code of an error -> text behind its sentence and "; ".
REMEDIES: Mapping[str, str] = {
    # library
    "camera_exists": "give another name with --name, or --overwrite to replace it",
    "no_camera": "crfnet camera list shows them",
    # movies and plates
    "exr_untagged": "add --encoded",
    "finished_differs": "or add --overwrite",
    "primaries_differ": "give them with --primaries",
    "primaries_unknown": "give them with --primaries",
    "single_file": "leave --frames out",
    # photograph
    "tagged_color_space": "--ignore-metadata does so",
    "tagged_encoding": "--ignore-metadata does so",
    "tagged_linear": "--ignore-metadata does so",
}
