# SPDX-License-Identifier: GPL-3.0-or-later
"""Change Blender's data as a completed job asks: after everything that can fail, and in Blender's thread only."""

import json
from pathlib import Path

import bpy

from crfnet.options import device_name

from ..work.errors import AddonError
from ..work.job import ApplyMode, Job
from ..work.run import CompletedJob
from ..work.wording import shortened
from . import stored_estimate
from .code_values import code_values
from .nodes import compositor, look_group, plate_group
from .nodes.links import LOOK, PLATE
from .plates import BAKED_FROM, CODE_VALUES_OF, SHADER, Datablock, alpha_mode, datablock_of_plate, release_pasted


def apply(context: bpy.types.Context, completed: CompletedJob) -> str:
    """Store the estimate on its plate, apply it as the job asks, and return the change in words.

    Raise AddonError or CRFNetError, and change nothing, if the plate was removed, the compositor is linked from another
    file, or the config lacks a color space that the nodes need.
    """
    job, datablock = completed.job, datablock_of_plate(completed.job.plate)
    release_pasted(PLATE, LOOK, CODE_VALUES_OF)
    if completed.is_applied and completed.files is None:
        plate_group.check_config()
        shown_tree(context, datablock)  # refuses one that is linked
    stored_estimate.store(datablock, completed.estimate)
    stored_estimate.set_entry(datablock, stored_estimate.EXPOSURE, completed.stops)
    stored_estimate.set_primaries(datablock, completed.primaries)
    if job.estimation.stored is None:
        stored_estimate.set_entry(datablock, stored_estimate.FILE_STATE, job.plate.file_state)
        stored_estimate.set_entry(datablock, stored_estimate.OFFERS, json.dumps(completed.offers, ensure_ascii=False))
    if job.estimation.origin:
        stored_estimate.set_entry(datablock, stored_estimate.ORIGIN, job.estimation.origin)
    remember_settings(datablock, job)
    if not completed.is_applied:
        return "the plate was not changed"
    look_group.update_look(context.scene, datablock, completed.estimate.curve, completed.stops)
    if completed.files is None:
        return _insert_nodes(context, datablock, completed)
    files, config = completed.files.files, completed.files.config
    stored_estimate.add_own_files(datablock, files)
    if config is not None:
        return f"{len(files)} files are in {config.parent}; start Blender with OCIO={config}"
    return _show_baked(context, datablock, files, completed.frames)


def remember_settings(datablock: Datablock, job: Job) -> None:
    """Remember the applied settings on the plate, where the panel shows them.

    `overwrite` and `force` are not remembered, so the user confirms them every time.
    """
    settings = datablock.camera_response_settings
    if job.output.mode is not ApplyMode.ESTIMATE:
        settings.chosen = job.output.mode.value  # the preferences stay as they are
    settings.anchor = job.exposure.anchor.value
    settings.gray = job.exposure.gray
    settings.exposure = job.exposure.stops
    settings.depth = job.output.depth
    options = job.estimation.options
    settings.camera = options.camera or ""
    settings.device = device_name(options.analysis.device) or "file"
    settings.ignore_metadata = not options.analysis.use_metadata
    settings.prior = str(options.prior)


def _insert_nodes(context: bpy.types.Context, datablock: Datablock, completed: CompletedJob) -> str:
    """Build the node group, and insert it after the plate in the compositor, or in the shader that the editor shows."""
    tree, name = shown_tree(context, datablock), completed.job.plate.name
    group = plate_group.build_group(datablock, name, completed.estimate.curve, completed.stops, kind=tree.bl_idname)
    wanted = compositor.PlateNodes(
        plate=datablock,
        codes=code_values(datablock),
        group=group,
        exposure=completed.stops,
        is_composed=completed.job.output.is_composed and compositor.can_compose(context, datablock),
        timing=compositor.timing_of(context, datablock, completed.frames),
    )
    compositor.apply_group(context.scene, tree, wanted)
    if tree.bl_idname == SHADER:
        return "its nodes linearize it in this shader; elsewhere it looks as before"
    hint = "; the compositor is switched off: tick Use Nodes" if compositor.is_switched_off(context.scene) else ""
    if wanted.is_composed:
        return f"its nodes linearize it behind the render, whose film is transparent now{hint}"
    return f"its nodes linearize it in the compositor; elsewhere it looks as before{hint}"


def _show_baked(
    context: bpy.types.Context, datablock: Datablock, files: tuple[Path, ...], frames: tuple[int, ...]
) -> str:
    """Load the linear files, and show them in the editor that shows the plate, with its timing."""
    timing = compositor.timing_of(context, datablock, frames)
    load = _linear_clip if isinstance(datablock, bpy.types.MovieClip) else _linear_image
    linear = load(datablock, files[0])
    linear[BAKED_FROM] = datablock.name
    space = context.space_data
    if space is not None and space.type == "IMAGE_EDITOR" and isinstance(linear, bpy.types.Image):
        space.image = linear
        if timing is not None:
            timing.set_on(space.image_user)
    if space is not None and space.type == "CLIP_EDITOR" and isinstance(linear, bpy.types.MovieClip):
        space.clip = linear
    return f"the linear plate is written to {shortened(str(files[0].parent))} and loaded"


def _linear_image(plate: bpy.types.Image, file: Path) -> bpy.types.Image:
    """Return the linear plate as an image in linear Rec.709; one that is loaded already is read again."""
    image = bpy.data.images.load(str(file), check_existing=True)
    image.source = plate.source if plate.source == "SEQUENCE" else "FILE"
    image.filepath = _path_like(plate, image.filepath)
    image.reload()
    image.alpha_mode = "CHANNEL_PACKED" if alpha_mode(plate) == "CHANNEL_PACKED" else "PREMUL"  # as OpenEXR demands
    image.colorspace_settings.name = plate_group.linear_rec709()
    return image


def _linear_clip(plate: bpy.types.MovieClip, file: Path) -> bpy.types.MovieClip:
    """Return the linear plate as a clip in linear Rec.709, with the plate's timing, tracks and camera.

    A clip of these files that is loaded already keeps its own tracks and camera.
    """
    clip = next((clip for clip in bpy.data.movieclips if bpy.path.abspath(clip.filepath) == str(file)), None)
    if clip is None:
        clip = plate.copy()
        clip.name = file.name
        stored_estimate.remove(clip)
        clip.use_proxy = False  # its proxies show the plate
    clip.filepath = _path_like(plate, str(file))  # reads the files again
    clip.frame_start, clip.frame_offset = plate.frame_start, plate.frame_offset
    clip.colorspace_settings.name = plate_group.linear_rec709()
    return clip


def _path_like(plate: Datablock, path: str) -> str:
    """Return a path relative to the .blend file if the plate's path is relative, else as it is."""
    return bpy.path.relpath(path) if plate.filepath.startswith("//") and bpy.data.filepath else path


def shown_tree(context: bpy.types.Context, plate: Datablock | None = None) -> bpy.types.NodeTree:
    """Return the compositor tree that the node editor shows, or the scene's if no node editor is active.

    If the editor shows a shader with the plate, return this. Raise AddonError if the tree is linked from another file,
    and so cannot be changed for good.
    """
    tree = compositor.shader_shown_in(context, plate) if plate is not None else None
    tree = tree or compositor.tree_shown_in(context) or compositor.compositor_tree(context.scene)
    if tree.library is not None or context.scene.library is not None:
        raise AddonError(f"The node tree {tree.name} is linked from another file: make it local first")
    return tree
