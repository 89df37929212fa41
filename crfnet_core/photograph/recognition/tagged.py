"""Photographs whose file names an encoding with a published curve: there is nothing to estimate."""

from __future__ import annotations

from pathlib import Path

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.metadata.color_tags import ColorTags
from crfnet_core.photograph.photo import Photo
from crfnet_core.photograph.recognition.log_curves import COLOR_SPACES

#: Encoding by the name that tags give it -> color space of OpenColorIO's ACES studio config.
TAGGED_SPACES = COLOR_SPACES | {
    "HLG": "Rec.2100-HLG - Display",
    "PQ": "Rec.2100-PQ - Display",
}


def refuse_tagged(photo: Photo) -> None:
    """Refuse a photograph whose metadata names an encoding with a published curve.

    Raises
    ------
    PhotoError
        If it does, with the color space to choose.
    """
    if photo.metadata is None or not photo.metadata.color.transfer:
        return
    transfer, source = photo.metadata.color.transfer, photo.metadata.color.source
    refuse_linear(photo.metadata.color, photo.path)
    if transfer not in TAGGED_SPACES:
        raise PhotoError("tagged_encoding", path=photo.path, transfer=transfer, source=source)
    space = TAGGED_SPACES[transfer]
    raise PhotoError("tagged_color_space", path=photo.path, transfer=transfer, source=source, space=space)


def refuse_linear(color: ColorTags, path: Path) -> None:
    """Refuse a file whose tags say that it is linear.

    Raises
    ------
    PhotoError
        If they do.
    """
    if color.transfer == "linear":
        raise PhotoError("tagged_linear", path=path, source=color.source)
