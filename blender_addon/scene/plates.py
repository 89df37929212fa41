# SPDX-License-Identifier: GPL-3.0-or-later
"""Which plate is meant, and where its code values lie on disk."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import bpy

from .. import lazy_import
from ..work.errors import AddonError

#: The editors with a panel.
EDITORS = ("IMAGE_EDITOR", "CLIP_EDITOR", "NODE_EDITOR")

OPEN_A_PLATE = {
    "IMAGE_EDITOR": "Open a photograph or a frame sequence first",
    "CLIP_EDITOR": "Open a frame sequence first",
    "NODE_EDITOR": "Select an Image or Movie Clip node that has a plate",
}

#: A name and its last number, which is that of the frame.
_FRAME_NUMBER = re.compile(r"(.*?)(\d+)(\D*)")

Datablock = bpy.types.Image | bpy.types.MovieClip


@dataclass(frozen=True)
class Plate:
    """A plate's files and what they are called; holds nothing of Blender, so it may travel to another thread.

    Parameters
    ----------
    name : str
        For people, files and nodes: the file's name without suffix and frame number.
    uid : int
        The datablock's session_uid.
    file : Path
        The file, or the sequence with a placeholder for the frame number.
    pattern : str
        The names of its files with ``*`` for the frame number.
    is_sequence : bool
        Whether `file` stands for frames.
    color_space : str
        The colour space that Blender takes the file for.
    folder : Path or None
        Where new files go unless told otherwise; None for a plate that has no file of its own.
    """

    name: str
    uid: int
    file: Path
    pattern: str
    is_sequence: bool
    color_space: str
    folder: Path | None


def active_datablock(context: bpy.types.Context) -> Datablock | None:
    """Return the image or clip that the editor shows, or that of the compositor's active node."""
    space = context.space_data
    if space is None:
        return None
    if space.type == "IMAGE_EDITOR":
        return space.image
    if space.type == "CLIP_EDITOR":
        return space.clip
    if space.type == "NODE_EDITOR" and space.tree_type == "CompositorNodeTree" and space.edit_tree:
        return node_plate(space.edit_tree.nodes.active)
    return None


def node_plate(node: bpy.types.Node | None) -> Datablock | None:
    """Return the image or clip of a compositor's Image or Movie Clip node."""
    if node is None:
        return None
    return {"IMAGE": getattr(node, "image", None), "MOVIECLIP": getattr(node, "clip", None)}.get(node.type)


def chosen_datablock(context: bpy.types.Context, image: str = "", clip: str = "") -> Datablock:
    """Return the image or clip of that name, or else the active one.

    Raises
    ------
    AddonError
        If there is none.
    """
    for name, collection, kind in ((image, bpy.data.images, "image"), (clip, bpy.data.movieclips, "clip")):
        if name:
            if name not in collection:
                raise AddonError(f"There is no {kind} {name!r} in this file")
            return collection[name]
    datablock = active_datablock(context)
    if datablock is None:
        raise AddonError("No plate is active: open one in the Image Editor, or give the name of an image or clip")
    return datablock


def datablock_of(plate: Plate) -> Datablock:
    """Return a plate's datablock, which may have gone while a run went on.

    Raises
    ------
    AddonError
        If it has.
    """
    for datablock in (*bpy.data.images, *bpy.data.movieclips):
        if datablock.session_uid == plate.uid:
            return datablock
    raise AddonError(f"{plate.name}: the image or clip was removed meanwhile")


def obstacle(datablock: Datablock) -> str:
    """Return why no response can be estimated from a datablock, or nothing; looks at no file."""
    if datablock.library is not None:
        return f"{datablock.name} is linked from another file: make it local first"
    if datablock.source == "MOVIE":
        return (
            "Movie files are not read: render the movie to an image sequence, without a view transform, and open that"
        )
    if datablock.source == "VIEWER":
        return "Renders have no camera response: open a photograph"
    if datablock.source == "TILED":
        return "Tiled images are not read: open a photograph"
    if datablock.source == "GENERATED" and datablock.is_float:
        return "Float images made in Blender hold linear values, which have no camera response: open a photograph"
    return ""


def plate_of(datablock: Datablock) -> Plate:
    """Return where a datablock's code values lie; those that are only in memory are written to a temporary file.

    Raises
    ------
    AddonError
        If it is none that a response can be estimated from.
    """
    if problem := obstacle(datablock):
        raise AddonError(problem)
    if isinstance(datablock, bpy.types.Image) and (datablock.packed_file or datablock.source == "GENERATED"):
        return _plate(datablock, lazy_import.load(".scene.packed_images").written_temporarily(datablock), folder=None)
    path = Path(bpy.path.abspath(datablock.filepath, library=datablock.library))
    if not datablock.filepath or (not path.is_file() and datablock.source != "SEQUENCE"):
        raise AddonError(
            f"{datablock.filepath or datablock.name}: there is no such file; find it with File, External Data"
        )
    return _plate(datablock, path, folder=path.parent)


def _plate(datablock: Datablock, path: Path, *, folder: Path | None) -> Plate:
    """Return the plate of a file, or of the sequence that the file is part of."""
    number = _FRAME_NUMBER.fullmatch(path.stem) if datablock.source == "SEQUENCE" else None
    name, pattern, file = path.stem, path.name, path
    if number is not None:
        before, digits, after = number.groups()
        name = (before.rstrip("._- ") + after) or Path(datablock.name).stem
        pattern = f"{before}*{after}{path.suffix}"
        file = path.with_name(f"{before}%0{len(digits)}d{after}{path.suffix}")
    return Plate(
        name=name,
        uid=datablock.session_uid,
        file=file,
        pattern=pattern,
        is_sequence=number is not None,
        color_space=datablock.colorspace_settings.name,
        folder=folder,
    )
