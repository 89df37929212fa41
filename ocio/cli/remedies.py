"""The option that helps, for errors whose own sentences name none: the text follows the sentence after "; "."""

from collections.abc import Mapping

#: Code of an error -> the remedy.
REMEDIES: Mapping[str, str] = {
    # photograph
    "tagged_color_space": "--ignore-metadata does so",
    "tagged_encoding": "--ignore-metadata does so",
    "tagged_linear": "--ignore-metadata does so",
}
