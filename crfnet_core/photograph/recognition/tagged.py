"""Pictures whose file names an encoding with a published curve: there is nothing to estimate."""

from __future__ import annotations

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.metadata.color_tags import ColorTags
from crfnet_core.photograph.photo import Photo
from crfnet_core.photograph.recognition.log_curves import COLOR_SPACES

#: Encoding by the name that tags give it -> colour space of OpenColorIO's ACES studio config.
TAGGED_SPACES = COLOR_SPACES | {
    "HLG": "Rec.2100-HLG - Display",
    "PQ": "Rec.2100-PQ - Display",
}

#: What to do if the tag is wrong.
_IF_WRONG = "if the tag is wrong, ignore metadata (--ignore-metadata)"


def refuse_tagged(photo: Photo) -> None:
    """Refuse a photograph whose metadata names an encoding with a published curve.

    Raises
    ------
    PhotoError
        If it does, with the colour space to choose.
    """
    refusal = tag_refusal(photo.metadata.color) if photo.metadata is not None else ""
    if refusal:
        raise PhotoError(f"{photo.path}: {refusal}")


def tag_refusal(color: ColorTags) -> str:
    """Return why a file with these tags is refused and what to do, in one line; empty if nothing is to be refused."""
    if not color.transfer:
        return ""
    if color.transfer == "linear":
        return f"is linear already: so says its metadata ({color.source}). Give it a linear colour space; {_IF_WRONG}"
    space = TAGGED_SPACES.get(color.transfer, "")
    named = f', in ACES configs "{space}"' if space else ""
    return (
        f"is encoded as {color.transfer}: so says its metadata ({color.source}). That curve is published, so give the"
        f" plate its colour space{named}, and no estimate; {_IF_WRONG}"
    )
