# SPDX-License-Identifier: GPL-3.0-or-later
"""The sidebar panel of the Image, Movie Clip, Compositor and Shader Editor, and the entries of their menus."""

from __future__ import annotations

import bpy

from ..scene import code_values, plates, stored_estimate
from ..scene.nodes import compositor, links
from ..work.job import WITHOUT_FILES
from . import running
from .estimate_box import draw_details, draw_estimate, draw_notices, draw_text
from .image_editor.image_tools import CRF_OT_pick_gray, CRF_OT_read_as_sequence, CRF_OT_show_plate
from .more.load_lut import CRF_OT_load_lut
from .more.looks import CRF_OT_add_look, draw_view
from .more.other_plates import CRF_OT_copy_response
from .operators import CRF_OT_apply_response, CRF_OT_cancel_run, CRF_OT_estimate_response
from .plate_settings import APPLIED, exported_config, is_applied, is_to_be_applied
from .preferences import APPLY_MODES

#: The menus of the three editors, by which Blender's search finds the operators, too.
MENUS = ("IMAGE_MT_image", "CLIP_MT_clip", "NODE_MT_node")


class ResponsePanel(bpy.types.Panel):
    """The panel, the same in every editor, in a tab of its own: elsewhere, Blender's panels push it out of sight."""

    bl_label = "Camera Response"
    bl_region_type = "UI"
    bl_category = "Response"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Return whether the editor can show a plate: of the node editors, the compositor's and the shaders' can."""
        return getattr(context.space_data, "tree_type", plates.SHADER) in plates.NODE_TREES

    def draw(self, context: bpy.types.Context) -> None:
        """Draw the button or the progress, the estimate of the plate with the button that applies it, and the rest."""
        layout, datablock = self.layout, plates.active_datablock(context)
        if run := running.current:
            row = layout.row(align=True)
            row.progress(factor=run.task.percent / 100, text=run.text)
            row.operator(CRF_OT_cancel_run.bl_idname, text="", icon="CANCEL")
        elif obstacle := plates.obstacle_in(context):
            draw_text(layout, obstacle, icon="INFO")
            if plates.is_tiled(datablock):
                layout.operator(CRF_OT_read_as_sequence.bl_idname, icon="SEQUENCE")
            elif CRF_OT_show_plate.poll(context):
                layout.operator(CRF_OT_show_plate.bl_idname, icon="LOOP_BACK")
        else:
            layout.operator(CRF_OT_estimate_response.bl_idname, icon="CAMERA_DATA")
        if datablock is None:
            return
        is_stored = stored_estimate.is_stored(datablock)
        if context.space_data.type == "NODE_EDITOR":  # which may show several plates
            layout.label(text=datablock.name, icon="IMAGE_DATA")
        if is_stored:
            draw_estimate(layout, context, datablock)
            with links.trees_at_rest():
                _draw_apply(layout, context, datablock)
                draw_notices(layout, datablock)
                _draw_warnings(layout, datablock)
            draw_details(layout, datablock)
        if is_stored or not plates.obstacle(datablock):
            _draw_more(layout, is_stored=is_stored)
            _draw_advanced(layout, context, datablock.camera_response_settings)


def draw_menu_entries(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    """Draw the entries of a menu, where there is a panel."""
    if ResponsePanel.poll(context):
        menu.layout.separator()
        menu.layout.operator(CRF_OT_estimate_response.bl_idname, icon="CAMERA_DATA")
        menu.layout.operator(CRF_OT_apply_response.bl_idname, icon="CHECKMARK")


def _draw_warnings(layout: bpy.types.UILayout, datablock: plates.Datablock) -> None:
    """Draw warnings: the file has changed, or nodes show an earlier one, linearize it twice or not at all."""
    state = plates.file_state(datablock)
    is_changed = stored_estimate.is_file_changed(datablock, state)
    draw_text(
        layout,
        "The file has changed since the estimate: estimate again." if is_changed else "",
        code_values.outdated(datablock, state),
        links.linearized_twice(datablock),
        links.without_group(datablock),
        links.in_earlier_space(datablock),
        icon="ERROR",
    )
    if code_values.is_painted_copy_shown(datablock):
        draw_text(layout, "Its nodes do not follow your painting: apply it again.", icon="INFO")


def _draw_apply(layout: bpy.types.UILayout, context: bpy.types.Context, datablock: plates.Datablock) -> None:
    """Draw the ways to apply the estimate, the button that does it, and the settings of the chosen way."""
    _draw_modes(layout, datablock)
    is_trusted = stored_estimate.verdict(datablock) != stored_estimate.DO_NOT_TRUST
    text, icon = ("Apply", "CHECKMARK") if is_trusted else ("Apply Anyway", "ERROR")
    if has_been := is_applied(datablock):
        text, icon = "Apply Again", "FILE_REFRESH"
    button = layout.operator(CRF_OT_apply_response.bl_idname, text=text, icon=icon)
    button.anyway = not is_trusted
    place = _place(context, datablock) if has_been else ""
    if has_been:
        draw_text(layout, "Applied with these settings.", icon="CHECKMARK")
        draw_text(layout, _next_step(context, datablock, place), icon="BLANK1")
    else:
        draw_text(layout, _waiting(context.scene, datablock), icon="INFO")
    _draw_settings(layout, context, datablock)
    if has_been and datablock.camera_response_settings.apply != "EXPORT":
        draw_view(layout, context.scene, datablock, is_composited=bool(place))


def _draw_modes(layout: bpy.types.UILayout, datablock: plates.Datablock) -> None:
    """Draw the ways to apply the estimate; Bake is gray for movies, and a line says why."""
    is_movie, row = datablock.source == "MOVIE", layout.row(align=True)
    for mode, *_ in APPLY_MODES:
        choice = row.row(align=True)
        choice.enabled = running.current is None and not (is_movie and mode == "BAKE")
        choice.prop_enum(datablock.camera_response_settings, "apply", mode)
    if is_movie:
        draw_text(layout, "Movies are not baked: use Nodes, or open an image sequence.", icon="INFO")


def _waiting(scene: bpy.types.Scene, datablock: plates.Datablock) -> str:
    """Return in words how what was applied differs from what the panel shows; an empty text if nothing was."""
    nodes = links.groups_of(datablock, scene)
    if not is_to_be_applied(datablock):
        is_new = APPLIED not in datablock[stored_estimate.KEY]
        return "Its nodes keep the earlier response until you apply this one." if nodes and is_new else ""
    if compositor.has_exposure(datablock, scene, stored_estimate.exposure(datablock)):
        return "Changed settings count once they are applied."
    exposures = {f"{node.inputs['Exposure'].default_value:.2f}" for node in nodes}
    return f"The nodes of this scene have exposure {' and '.join(sorted(exposures))} until you apply."


def _next_step(context: bpy.types.Context, datablock: plates.Datablock, place: str) -> str:
    """Return where the result of what was applied is (`place`, of nodes), or what it is for."""
    match datablock.camera_response_settings.apply:
        case "NODES":
            return place
        case "EXPORT":
            return f"Start Blender with OCIO={exported_config(datablock)}"
    every = bpy.data.images if isinstance(datablock, bpy.types.Image) else bpy.data.movieclips
    baked = next((each.name for each in every if each.get(plates.BAKED_FROM) == datablock.name), "")
    choose = ": choose it in a new node" if context.space_data.type == "NODE_EDITOR" else ""
    return f'The linear plate is "{baked}"{choose}.' if baked else ""


def _place(context: bpy.types.Context, datablock: plates.Datablock) -> str:
    """Return where the nodes of an applied plate in the compositor show it, or how they come to; empty in a shader."""
    if getattr(context.space_data, "tree_type", "") == plates.SHADER:
        return ""
    groups = [node for node in links.groups_of(datablock, context.scene) if node.bl_idname == "CompositorNodeGroup"]
    behind = [node for group in groups for node in links.nodes_behind(group)]
    if not groups:
        return ""
    if compositor.is_switched_off(context.scene):
        return "The compositor is switched off: tick Use Nodes."
    if any(compositor.is_output(node, context.scene) for node in behind):
        return "It is in the compositor: F12 renders it."
    if any(node.type == "VIEWER" for node in behind):
        return "A Viewer in the compositor shows it; the render does not. Link it to what goes to the output."
    return "Its node group in the compositor leads nowhere: link it on."


def _draw_settings(layout: bpy.types.UILayout, context: bpy.types.Context, datablock: plates.Datablock) -> None:
    """Draw the settings that matter for the chosen way to apply the response."""
    settings = datablock.camera_response_settings
    if settings.apply == "NODES" and compositor.can_compose(context, datablock):
        layout.prop(settings, "compose")
    column = _split_column(layout)
    column.prop(settings, "exposure")
    if settings.apply == "BAKE":
        column.prop(settings, "depth")
    if settings.apply not in WITHOUT_FILES:
        column.prop(settings, "folder", placeholder="Folder of the plate")
        column.prop(settings, "overwrite")


def _draw_more(layout: bpy.types.UILayout, *, is_stored: bool) -> None:
    """Draw further uses of the response of a plate, and the button that loads one, closed at first."""
    header, body = layout.panel("CRF_more", default_closed=True)
    header.label(text="More")
    if body is not None:
        column = body.column(align=True)
        column.operator(CRF_OT_load_lut.bl_idname, icon="FILE_FOLDER")
        if is_stored:
            column.operator(CRF_OT_add_look.bl_idname, icon="CAMERA_DATA")
            column.operator(CRF_OT_copy_response.bl_idname, icon="DUPLICATE")


def _draw_advanced(layout: bpy.types.UILayout, context: bpy.types.Context, settings: bpy.types.PropertyGroup) -> None:
    """Draw settings that few plates need, closed at first."""
    header, body = layout.panel("CRF_advanced", default_closed=True)
    header.label(text="Advanced")
    if body is None:
        return
    column = _split_column(body)
    column.prop(settings, "anchor")
    if settings.anchor == "GRAY":
        row = column.row(align=True)
        row.prop(settings, "gray", slider=True)
        if context.space_data.type == "IMAGE_EDITOR":
            row.operator(CRF_OT_pick_gray.bl_idname, text="", icon="EYEDROPPER")
    for name in ("camera", "prior", "device", "ignore_metadata", "force"):
        column.prop(settings, name)


def _split_column(layout: bpy.types.UILayout) -> bpy.types.UILayout:
    """Return a column of properties with their names at the left, gray while a run goes by earlier settings."""
    column = layout.column()
    column.enabled = running.current is None
    column.use_property_split = True
    column.use_property_decorate = False
    return column


_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    [type(f"CRF_PT_{editor.lower()}", (ResponsePanel,), {"bl_space_type": editor}) for editor in plates.EDITORS]
)


def register() -> None:
    """Register the panels, and add the entries to the menus."""
    _register_classes()
    for name in MENUS:
        getattr(bpy.types, name).append(draw_menu_entries)


def unregister() -> None:
    """Remove the entries, and unregister the panels."""
    for name in MENUS:
        getattr(bpy.types, name).remove(draw_menu_entries)
    _unregister_classes()
