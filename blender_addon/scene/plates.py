# SPDX-License-Identifier: GPL-3.0-or-later
"""Which image or clip is meant, and where its code values lie on disk."""

from __future__ import annotations

from pathlib import Path
from typing import TypeAlias

import bpy

from .. import lazy_import
from ..work.errors import AddonError
from ..work.job import Plate
from . import comparison

#: The editors that have the panel.
EDITORS = ("IMAGE_EDITOR", "CLIP_EDITOR", "NODE_EDITOR")

#: What the panel of each editor asks for while there is no plate.
OPEN_A_PLATE = {
    "IMAGE_EDITOR": "Open a photograph or a frame sequence first",
    "CLIP_EDITOR": "Open a frame sequence first",
    "NODE_EDITOR": "Select an Image or Movie Clip node that has a plate",
}

#: What a plate is in Blender's data.
Datablock: TypeAlias = bpy.types.Image | bpy.types.MovieClip


def active_datablock(context: bpy.types.Context) -> Datablock | None:
    """Return the image or clip that the editor shows; in the compositor, that of the active node.

    While an Image Editor shows the linear plate for comparison, it is the plate.
    """
    space = context.space_data
    if space is None:
        return None
    if space.type == "IMAGE_EDITOR":
        return comparison.plate_of(space.image) or space.image
    if space.type == "CLIP_EDITOR":
        return space.clip
    if space.type == "NODE_EDITOR" and space.tree_type == "CompositorNodeTree" and space.edit_tree:
        return datablock_of_node(space.edit_tree.nodes.active)
    return None


def datablock_of_node(node: bpy.types.Node | None) -> Datablock | None:
    """Return the image or clip of a compositor's Image or Movie Clip node; None for any other node."""
    if node is None:
        return None
    return {"IMAGE": getattr(node, "image", None), "MOVIECLIP": getattr(node, "clip", None)}.get(node.type)


def chosen_datablock(context: bpy.types.Context, image: str = "", clip: str = "") -> Datablock:
    """Return the image or clip of the given name, or the active one if no name is given.

    Raises
    ------
    AddonError
        If there is no such image or clip, or none is active.
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


def datablock_of_plate(plate: Plate) -> Datablock:
    """Return the image or clip of a plate.

    Raises
    ------
    AddonError
        If it was removed while the job ran.
    """
    for datablock in (*bpy.data.images, *bpy.data.movieclips):
        if datablock.session_uid == plate.uid:
            return datablock
    raise AddonError(f"{plate.name}: the image or clip was removed meanwhile")


def obstacle(datablock: Datablock) -> str:
    """Return why no response can be estimated from an image or clip, or an empty text; reads no file."""
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
    """Return the plate of an image or clip; pixels that are only in memory are written to a temporary file.

    Raises
    ------
    AddonError
        If no response can be estimated from it, or its file is not found.
    """
    if problem := obstacle(datablock):
        raise AddonError(problem)
    if isinstance(datablock, bpy.types.Image) and (datablock.packed_file or datablock.source == "GENERATED"):
        path = lazy_import.load(".scene.packed_images").write_temporary_file(datablock)
        return _plate(datablock, path, folder=None, has_metadata=bool(datablock.packed_file))
    path = Path(bpy.path.abspath(datablock.filepath, library=datablock.library))
    if not datablock.filepath or (not path.is_file() and datablock.source != "SEQUENCE"):
        raise AddonError(
            f"{datablock.filepath or datablock.name}: there is no such file; find it with File, External Data"
        )
    return _plate(datablock, path, folder=path.parent)


def _plate(datablock: Datablock, path: Path, *, folder: Path | None, has_metadata: bool = True) -> Plate:
    """Return the plate of an image or clip whose code values, or first frame, are in a file."""
    return Plate.of_file(
        path,
        is_sequence=datablock.source == "SEQUENCE",
        datablock_name=datablock.name,
        uid=datablock.session_uid,
        color_space=datablock.colorspace_settings.name,
        folder=folder,
        has_metadata=has_metadata,
    )
