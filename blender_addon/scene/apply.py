# SPDX-License-Identifier: GPL-3.0-or-later
"""What a run changes in Blender's data, all of it after everything that can fail; in Blender's thread only."""

from __future__ import annotations

from collections.abc import Callable

import bpy

from ocio.plates.frames import find_frames

from ..ui.gather import Request
from ..work.run import Outcome
from ..work.writers import Baked
from . import color_management, compositor, node_group, stored_estimate
from .plates import Datablock, datablock_of


def finish(context: bpy.types.Context, request: Request, outcome: Outcome) -> str:
    """Store the estimate on its plate, apply it, and return what was done, in a sentence.

    Raises
    ------
    AddonError, CRFNetError
        If the plate has gone, or the config has no linear Rec.709; nothing is changed then.
    """
    datablock = datablock_of(request.plate)
    if request.apply == "NODES":
        node_group.check_config()
    stored_estimate.store(datablock, outcome.estimate, list(outcome.lines))
    stored_estimate.remember(datablock, "exposure", outcome.exposure)
    keep_choices(datablock, request)
    return _FINISHERS[request.apply](context, datablock, request, outcome)


def keep_choices(datablock: Datablock, request: Request) -> None:
    """Let the panel show what was applied, for the next time; to overwrite or to insist is asked for each time."""
    for name in ("apply", "anchor", "gray", "exposure", "depth"):
        setattr(datablock.camera_response_settings, name, getattr(request, name))


def _finish_nodes(context: bpy.types.Context, datablock: Datablock, request: Request, outcome: Outcome) -> str:
    """Build the node group and put it behind the plate."""
    data_space = node_group.data_space()
    datablock.colorspace_settings.name = data_space
    group = node_group.build_group(request.plate.name, outcome.estimate.curve, outcome.exposure)
    compositor.apply_group(_tree(context), datablock, group, outcome.exposure, frames=_frames(request))
    return f'node group "{group.name}" linearises it in the compositor; its colour space is now {data_space}'


def _finish_color_space(_context: bpy.types.Context, datablock: Datablock, request: Request, outcome: Outcome) -> str:
    """Set the colour space if Blender has it, else leave a note for the next start."""
    files = outcome.files
    is_available = files.color_space in color_management.color_spaces()
    if is_available:
        datablock.colorspace_settings.name = files.color_space
    else:
        stored_estimate.remember(datablock, stored_estimate.PENDING, files.color_space)
    if is_available and not files.is_changed:
        return f'its colour space is "{files.color_space}"'
    if request.is_config_demanded or files.config.parent != color_management.user_folder():
        return (
            f'restart Blender once with the environment variable OCIO set to {files.config} for "{files.color_space}"'
        )
    return f'save the file and restart Blender once: the colour space "{files.color_space}" is there from then on'


def _finish_bake(context: bpy.types.Context, datablock: Datablock, request: Request, outcome: Outcome) -> str:
    """Load the linear files, and show them where the plate was shown."""
    baked = _loaded(outcome.files, is_clip=isinstance(datablock, bpy.types.MovieClip))
    space = context.space_data
    if space is not None and space.type == "IMAGE_EDITOR" and isinstance(baked, bpy.types.Image):
        space.image = baked
        compositor.show_frames(space.image_user, _frames(request))
    if space is not None and space.type == "CLIP_EDITOR" and isinstance(baked, bpy.types.MovieClip):
        space.clip = baked
    return f'linear plate "{baked.name}" is written to {request.folder} and loaded'


def _frames(request: Request) -> tuple[int, ...]:
    """Return the frame numbers of a sequence; none for a single file."""
    return find_frames(request.plate.file).numbers if request.plate.is_sequence else ()


def _loaded(baked: Baked, *, is_clip: bool) -> Datablock:
    """Return the linear plate as an image or clip in linear Rec.709; one that is there already is read again."""
    collection, first = (bpy.data.movieclips if is_clip else bpy.data.images), str(baked.files[0])
    datablock = collection.load(first, check_existing=True)
    if not is_clip:
        datablock.source = "SEQUENCE" if baked.is_sequence else "FILE"
        datablock.reload()
    datablock.colorspace_settings.name = node_group.linear_rec709()
    return datablock


def _finish_export(_context: bpy.types.Context, _datablock: Datablock, _request: Request, outcome: Outcome) -> str:
    """Say where the files are."""
    return f"{len(outcome.files.files)} files are in {outcome.files.folder}"


_FINISHERS: dict[str, Callable[[bpy.types.Context, Datablock, Request, Outcome], str]] = {
    "NODES": _finish_nodes,
    "COLORSPACE": _finish_color_space,
    "BAKE": _finish_bake,
    "EXPORT": _finish_export,
}


def _tree(context: bpy.types.Context) -> bpy.types.NodeTree:
    """Return the compositor tree that is being edited, or else the scene's."""
    space = context.space_data
    if (
        space is not None
        and space.type == "NODE_EDITOR"
        and space.tree_type == "CompositorNodeTree"
        and space.edit_tree
    ):
        return space.edit_tree
    return compositor.compositor_tree(context.scene)
