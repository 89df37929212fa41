"""Photographs whose file names an encoding with a published curve: there is nothing to estimate."""

from __future__ import annotations

from pathlib import Path

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.metadata.color_tags import ColorTags
from crfnet_core.photograph.photo import Photo
from crfnet_core.photograph.recognition.log_curves import COLOR_SPACES

#: Encoding by the name that tags give it -> color space of OpenColorIO's ACES studio config.
TAGGED_SPACES = COLOR_SPACES | {"HLG": "Rec.2100-HLG - Display", "PQ": "Rec.2100-PQ - Display"}


def refuse_tagged(photo: Photo) -> None:
    """Raise PhotoError if the metadata name an encoding with a published curve, with the color space to choose."""
    if photo.metadata is None or not photo.metadata.color.transfer:
        return
    refuse_linear(photo.metadata.color, photo.path)
    transfer = photo.metadata.color.transfer
    space = TAGGED_SPACES.get(transfer, "")
    code = "tagged_color_space" if space else "tagged_encoding"
    raise PhotoError(code, path=photo.path, transfer=transfer, source=photo.metadata.color.source, space=space)


def refuse_linear(color: ColorTags, path: Path) -> None:
    """Raise PhotoError if the tags of a file say that it is linear."""
    if color.transfer == "linear":
        raise PhotoError("tagged_linear", path=path, source=color.source)
