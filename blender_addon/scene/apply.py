# SPDX-License-Identifier: GPL-3.0-or-later
"""What a completed job changes in Blender's data: after everything that can fail, and in Blender's thread only."""

from __future__ import annotations

from pathlib import Path

import bpy

from ocio.configs.installed import Installed

from ..work.job import Job, RunningConfig
from ..work.run import CompletedJob
from ..work.writers import Baked, Exported
from . import color_management, compositor, node_group, stored_estimate
from .plates import Datablock, datablock_of_plate


def apply(context: bpy.types.Context, completed: CompletedJob) -> str:
    """Store the estimate on its plate, apply it as the job asks, and return what was done, in words.

    Raises
    ------
    AddonError, CRFNetError
        If the plate was removed, or the config lacks a colour space that the nodes need; nothing is changed then.
    """
    job, datablock = completed.job, datablock_of_plate(completed.job.plate)
    if completed.is_applied and completed.files is None:
        node_group.check_config()
    stored_estimate.store(datablock, completed.estimate, lines=completed.lines)
    stored_estimate.set_entry(datablock, stored_estimate.EXPOSURE, completed.stops)
    remember_settings(datablock, job)
    if not completed.is_applied:
        return "nothing else was changed"
    match completed.files:
        case None:
            return _insert_nodes(context, datablock, completed)
        case Installed() as installed:
            return _set_color_space(datablock, installed, job.config)
        case Baked() as baked:
            return _show_baked(context, datablock, baked, completed.frames)
        case Exported() as exported:
            return f"{len(exported.files)} files are in {exported.folder}"


def remember_settings(datablock: Datablock, job: Job) -> None:
    """Remember the applied settings on the plate, where the panel shows them.

    `overwrite` and `force` are not remembered, so the user confirms them every time.
    """
    settings = datablock.camera_response_settings
    settings.apply = job.output.mode.value
    settings.anchor = job.exposure.anchor.value
    settings.gray = job.exposure.gray
    settings.exposure = job.exposure.stops
    settings.depth = job.output.depth
    options = job.estimation.options
    settings.ignore_metadata = not options.use_metadata
    settings.prior = "file" if isinstance(options.prior, Path) else options.prior
    if settings.prior == "file" and Path(bpy.path.abspath(settings.prior_file)) != options.prior:
        settings.prior_file = str(options.prior)


def _insert_nodes(context: bpy.types.Context, datablock: Datablock, completed: CompletedJob) -> str:
    """Build the node group, and insert it after the plate in the compositor."""
    data_space = node_group.data_space()
    datablock.colorspace_settings.name = data_space
    group = node_group.build_group(completed.job.plate.name, completed.estimate.curve, completed.stops)
    compositor.apply_group(_tree(context), datablock, group, completed.stops, frames=completed.frames)
    return f'node group "{group.name}" linearises it in the compositor; its colour space is now {data_space}'


def _set_color_space(datablock: Datablock, installed: Installed, running: RunningConfig) -> str:
    """Set the colour space if this session has it; else remember it until Blender has been restarted."""
    name, config = installed.color_space, installed.config
    is_available = name in color_management.color_spaces()
    if is_available:
        datablock.colorspace_settings.name = name
    else:
        stored_estimate.set_entry(datablock, stored_estimate.PENDING_COLOR_SPACE, name)
    if is_available and not installed.is_changed:
        return f'its colour space is "{name}"'
    if running.is_demanded or config.parent != color_management.user_folder():
        return f'restart Blender once with the environment variable OCIO set to {config} for "{name}"'
    return f'save the file and restart Blender once: the colour space "{name}" is there from then on'


def _show_baked(context: bpy.types.Context, datablock: Datablock, baked: Baked, frames: tuple[int, ...]) -> str:
    """Load the linear files, and show them in the editor that shows the plate."""
    linear = _load(baked, is_clip=isinstance(datablock, bpy.types.MovieClip))
    space = context.space_data
    if space is not None and space.type == "IMAGE_EDITOR" and isinstance(linear, bpy.types.Image):
        space.image = linear
        compositor.show_frames(space.image_user, frames)
    if space is not None and space.type == "CLIP_EDITOR" and isinstance(linear, bpy.types.MovieClip):
        space.clip = linear
    return f'linear plate "{linear.name}" is written to {baked.files[0].parent} and loaded'


def _load(baked: Baked, *, is_clip: bool) -> Datablock:
    """Return the linear plate as an image or clip in linear Rec.709; one that is loaded already is read again."""
    collection, first = (bpy.data.movieclips if is_clip else bpy.data.images), str(baked.files[0])
    datablock = collection.load(first, check_existing=True)
    if not is_clip:
        datablock.source = "SEQUENCE" if baked.is_sequence else "FILE"
        datablock.reload()
    datablock.colorspace_settings.name = node_group.linear_rec709()
    return datablock


def _tree(context: bpy.types.Context) -> bpy.types.NodeTree:
    """Return the compositor tree that the node editor shows, or the scene's if no node editor is active."""
    space = context.space_data
    if (
        space is not None
        and space.type == "NODE_EDITOR"
        and space.tree_type == "CompositorNodeTree"
        and space.edit_tree
    ):
        return space.edit_tree
    return compositor.compositor_tree(context.scene)
