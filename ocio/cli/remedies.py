"""The option that helps, for errors whose own sentences name none: the text follows the sentence after "; "."""

from collections.abc import Mapping

#: Code of an error -> the remedy.
REMEDIES: Mapping[str, str] = {
    # library
    "camera_exists": "give another name with --name, or --overwrite to replace it",
    "no_camera": "crfnet camera list shows them",
}
