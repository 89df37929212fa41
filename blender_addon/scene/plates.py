# SPDX-License-Identifier: GPL-3.0-or-later
"""Find the image or clip that the user means, and its code values on disk."""

import hashlib
from pathlib import Path
from typing import Any, TypeAlias

import bpy

from .. import lazy_import
from ..work import job
from ..work.errors import AddonError
from ..work.job import Plate
from .packed_images import codes_of_frame, codes_of_pixels, file_name, has_own_file, is_painted, shown_number

EDITORS = ("IMAGE_EDITOR", "CLIP_EDITOR", "NODE_EDITOR")  # that have the panel
COMPOSITOR, SHADER = NODE_TREES = ("CompositorNodeTree", "ShaderNodeTree")  # that show plates

#: Suffixes of photographs that the estimator reads and Blender does not, or only some versions of it.
HEIF_SUFFIXES = (".heic", ".heif", ".hif", ".avif")

#: The panel's request in each editor while there is no plate.
OPEN_A_PLATE = {
    "IMAGE_EDITOR": "Open a photograph, sequence or movie first",
    "CLIP_EDITOR": "Open a sequence or movie first",
    "NODE_EDITOR": "Select a node that shows an image or movie clip",
}

# Custom properties of data that was made for a plate, with the plate as their value:
CODE_VALUES_OF = "camera_response_code_values_of"  # a copy whose pixels are code values, see `code_values`
COMPARED_PLATE = "camera_response_plate"  # a linear plate that is only shown for comparison
BAKED_FROM = "camera_response_baked_from"  # a linear plate that was baked: only the plate's name
_HASH = "camera_response_hash"  # the first `short_hash` of a plate; the plate has it, too

#: The nodes that show an image or clip, by their type: its attribute.
SHOWN = {"IMAGE": "image", "MOVIECLIP": "clip", "TEX_IMAGE": "image", "TEX_ENVIRONMENT": "image"}

Datablock: TypeAlias = bpy.types.Image | bpy.types.MovieClip


def active_datablock(context: bpy.types.Context) -> Datablock | None:
    """Return the image or clip that the editor shows; of nodes, the active one's or else the only one.

    While an editor shows the linear plate for comparison, or a plate's code values, it is the plate. If a plate's node
    group is active, it is the plate that the group linearizes.
    """
    space = context.space_data
    if space is None:
        return None
    if space.type == "IMAGE_EDITOR":
        return compared_plate(space.image) or plate_itself(space.image)
    if space.type == "CLIP_EDITOR":
        return plate_itself(space.clip)
    if space.type == "NODE_EDITOR" and space.tree_type in NODE_TREES and space.edit_tree:
        return _plate_among(space.edit_tree.nodes)
    return None


def compared_plate(image: bpy.types.Image | None) -> bpy.types.Image | None:
    """Return the plate that `image` previews in linear light, or None."""
    return None if image is None else image.get(COMPARED_PLATE)


def datablock_of_node(node: bpy.types.Node | None) -> Datablock | None:
    """Return the plate of a node that shows an image or clip, which may be its code values; else None."""
    return plate_itself(shown_by_node(node))


def plate_itself(datablock: Datablock | None) -> Datablock | None:
    """Return the plate of an image or clip that is the copy of its code values; any other image or clip as it is."""
    return None if datablock is None else datablock.get(CODE_VALUES_OF) or datablock


def shown_by_node(node: bpy.types.Node | None) -> Datablock | None:
    """Return the image or clip that a compositor's or shader's node shows itself; None for any other node."""
    attribute = SHOWN.get(getattr(node, "type", ""))
    return None if attribute is None else getattr(node, attribute, None)


def _plate_among(nodes: bpy.types.Nodes) -> Datablock | None:
    """Return the plate of the active node, for a plate's node group of the node at its first input; or the only one."""
    node, properties = nodes.active, (getattr(nodes.active, "node_tree", None) or {}).keys()
    if not any(name.startswith("camera_response") for name in properties):
        all_plates = {datablock_of_node(each) for each in nodes} - {None}
        return datablock_of_node(node) or (all_plates.pop() if len(all_plates) == 1 else None)
    seen: set[bpy.types.Node] = set()
    while node not in (None, *seen) and datablock_of_node(node) is None:
        seen.add(node)
        source = node.inputs.get("Image") or next(iter(node.inputs), None)
        node = source.links[0].from_node if source is not None and source.links else None
    return datablock_of_node(node)


def chosen_datablock(context: bpy.types.Context, image: str = "", clip: str = "") -> Datablock:
    """Return the image or clip of a name, or the active one if both names are empty; raise AddonError if none is."""
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
    """Return the image or clip of a plate; raise AddonError if it was removed while the job ran."""
    for datablock in (*bpy.data.images, *bpy.data.movieclips):
        if datablock.session_uid == plate.uid:
            return datablock
    raise AddonError(f"{plate.name}: the image or clip was removed meanwhile")


def obstacle_in(context: bpy.types.Context) -> str:
    """Return why no response can be estimated in one of the `EDITORS`, or an empty text; reads no file."""
    datablock = active_datablock(context)
    if datablock is not None:
        return obstacle(datablock)
    return lazy_import.missing() or OPEN_A_PLATE[context.area.type]


def is_tiled(datablock: Datablock | None) -> bool:
    """Return whether Blender took the frames of an image for UDIM tiles."""
    return datablock is not None and datablock.source == "TILED"


def obstacle(datablock: Datablock) -> str:
    """Return why no response can be estimated from an image or clip, or an empty text; reads no file."""
    if problem := lazy_import.missing() or why_unchangeable(datablock):
        return problem
    if CODE_VALUES_OF in datablock:
        return "These are the code values of a plate, not the plate: open the photograph itself"
    if BAKED_FROM in datablock:
        return f"This is linear already: it was baked from {datablock[BAKED_FROM]}"
    if getattr(datablock, "use_multiview", False):  # which clips do not have
        return "This image holds views for two eyes: open the picture of one eye, and untick Use Multi-View"
    if datablock.filepath.lower().endswith(".gif"):
        return (
            "GIF files hold at most 256 colors, too few for an estimate: open the photograph or movie it was made from"
        )
    return _OBSTACLES.get(datablock.source, "") or _obstacle_in_blender(datablock)


def why_unchangeable(datablock: Datablock) -> str:
    """Return why nothing that is changed on an image or clip would be saved, or an empty text."""
    return "" if datablock.library is None else f"{datablock.name} is linked from another file: make it local first"


def is_shown(datablock: Datablock) -> bool:
    """Return whether Blender shows an image or clip: HEIC it does not, and AVIF only some versions do."""
    return not is_heif(datablock) or all(datablock.size)


def is_heif(datablock: Datablock) -> bool:
    """Return whether an image is a HEIC or AVIF file."""
    return datablock.filepath.lower().endswith(HEIF_SUFFIXES)


#: Why images of some sources have no response to estimate.
_OBSTACLES = {
    "VIEWER": "Renders have no camera response: open a photograph",
    "TILED": "Blender took these files for UDIM tiles: set Source to Image Sequence",
}


def _obstacle_in_blender(datablock: Datablock) -> str:
    """Return why an image that was generated, or painted on, in Blender has no response; else an empty text."""
    if datablock.source != "GENERATED":
        if getattr(datablock, "is_dirty", False):
            return f"{datablock.name} has unsaved changes: save, pack or reload it in the Image menu first"
        return ""
    if datablock.is_float:
        return "Float images made in Blender hold linear values, which have no camera response: open a photograph"
    if datablock.is_dirty:
        return ""
    if datablock.packed_file:
        return f"{datablock.name} shows what Blender generates, not its packed file: set Source to Single Image"
    return "Blank images and test grids have no camera response: open a photograph"


def plate_of(datablock: Datablock, *, is_only_read: bool = False) -> Plate:
    """Return the plate of an image or clip, with pixels that are only in memory: painted ones, a movie's frame.

    Raise AddonError if no response can be estimated from it, or its file is not found. One that `is_only_read` may be
    linked from another file.
    """
    if (problem := obstacle(datablock)) and not (is_only_read and problem == why_unchangeable(datablock)):
        raise AddonError(problem)
    if not has_own_file(datablock):
        name = file_name(datablock)
        content = codes_of_pixels(datablock) if is_painted(datablock) else datablock.packed_file.data
        return _plate(datablock, name, folder=None, has_metadata=isinstance(content, bytes), content=content)
    path = _path(datablock)
    if not datablock.filepath or (not path.is_file() and datablock.source != "SEQUENCE"):
        raise AddonError(f"{datablock.filepath or datablock.name}: does not exist; find it with File, External Data")
    if datablock.source != "MOVIE":
        return _plate(datablock, path, folder=path.parent)
    number, count = shown_number(datablock), max(1, datablock.frame_duration)
    frame = {"content": codes_of_frame(datablock, number), "shown_frame": number, "frame_count": count}
    return _plate(datablock, path, folder=path.parent, has_metadata=False, **frame)


def name_of(datablock: Datablock) -> str:
    """Return the name of a plate: its file name without suffix and frame number. The file need not be there."""
    path = _path(datablock) if has_own_file(datablock) else file_name(datablock)
    return _plate(datablock, path, folder=None).name


def file_state(datablock: Datablock) -> str:
    """Return the state of a plate's file, of a sequence of one frame; empty if it is not found or there is none."""
    has_file = datablock.filepath and has_own_file(datablock)
    return job.file_state(_path(datablock)) if has_file else ""


def short_hash(datablock: Datablock) -> str:
    """Return four digits that differ between plates of one name: Blender takes data of one name for the same.

    It does so where nodes are copied from one .blend file to another.
    """
    path = str(_path(datablock)) if has_own_file(datablock) else f"{bpy.data.filepath}/{datablock.name}"
    return hashlib.sha256(path.encode(errors="surrogateescape")).hexdigest()[:4]


def mark(made: bpy.types.ID, name: str, plate: Datablock) -> None:
    """Note on a node group or copy, in a custom property of a name, that it was made for a plate."""
    plate[_HASH] = plate.get(_HASH) or short_hash(plate)
    made[name], made[_HASH] = plate, plate[_HASH]


def release_pasted(*names: str) -> None:
    """Empty the custom properties of these names on data that was pasted from another file without its plate.

    Blender then takes the plate of the same name in this file for it. Such nodes stay as they are.
    """
    for made in (*bpy.data.node_groups, *bpy.data.images, *bpy.data.movieclips):
        for name in names:
            plate = made.get(name)
            if plate and made.get(_HASH, plate.get(_HASH)) != plate.get(_HASH) and made.library is None:
                made[name] = ""


def alpha_mode(datablock: Datablock) -> str:
    """Return how Blender takes the alpha of an image; empty where it has no such setting or ignores it.

    It divides by alpha only where it reads a file: painted pixels are never multiplied by it.
    """
    is_heeded = isinstance(datablock, bpy.types.Image) and datablock.source != "MOVIE" and is_shown(datablock)
    if not is_heeded:
        return ""
    return "STRAIGHT" if datablock.alpha_mode == "PREMUL" and is_painted(datablock) else datablock.alpha_mode


def _path(datablock: Datablock) -> Path:
    """Return the file of an image or clip."""
    return Path(bpy.path.abspath(datablock.filepath, library=datablock.library))


def _plate(datablock: Datablock, path: Path, **details: Any) -> Plate:
    """Return the plate of an image or clip whose code values, or first frame, are in a file."""
    return Plate.from_file(
        path,
        is_sequence=datablock.source == "SEQUENCE",
        datablock_name=datablock.name,
        uid=datablock.session_uid,
        color_space=datablock.colorspace_settings.name,
        file_state=file_state(datablock),
        alpha_mode=alpha_mode(datablock),
        **details,
    )
