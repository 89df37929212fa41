"""The window: its look, its editors, where they are on the screen, and which button is under the mouse."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import bpy

#: What Blender calls the editors whose names for Python and for the interface differ.
INTERFACE_NAMES = {"NODE_EDITOR": "CompositorNodeTree"}


def window() -> bpy.types.Window:
    """Return the only window."""
    return bpy.context.window_manager.windows[0]


def area(kind: str) -> bpy.types.Area:
    """Return the first area that shows an editor, such as ``IMAGE_EDITOR``."""
    return next(area for area in window().screen.areas if area.type == kind)


def region(kind: str, of: str) -> bpy.types.Region:
    """Return a region of an editor, such as its sidebar, ``UI``."""
    return next(region for region in area(kind).regions if region.type == of)


def context(kind: str, of: str = "WINDOW") -> Any:
    """Return the context of a region, for a `with` statement."""
    return bpy.context.temp_override(window=window(), screen=window().screen, area=area(kind), region=region(kind, of))


def box(kind: str, of: str) -> list[int]:
    """Return where a region is on the screen: x, y, width and height in pixels, (x, y) its upper left corner."""
    found = region(kind, of)
    return [found.x, window().height - found.y - found.height, found.width, found.height]


def look(*, scale: float, theme: str) -> None:
    """Set the scale of the interface, and the theme: ``dark``, the default, or ``light``, which comes with Blender."""
    preferences = bpy.context.preferences
    preferences.view.use_save_prompt = False
    preferences.view.ui_scale = scale
    if theme == "light":
        (path,) = (
            found
            for folder in bpy.utils.preset_paths("interface_theme")
            for found in Path(folder).glob("[Bb]lender_[Ll]ight.xml")
        )
        with context("VIEW_3D"):
            bpy.ops.script.execute_preset(filepath=str(path), menu_idname="USERPREF_MT_interface_theme_presets")


def show(kind: str, *, alone: bool = True) -> None:
    """Turn the largest area into an editor with an open sidebar, alone in the window or beside the others."""
    largest = max(window().screen.areas, key=lambda area: area.width * area.height)
    largest.ui_type = INTERFACE_NAMES.get(kind, kind)
    largest.spaces.active.show_region_ui = True
    if alone:
        with bpy.context.temp_override(window=window(), screen=window().screen, area=largest):
            bpy.ops.screen.screen_full_area()


def show_tab(kind: str) -> None:
    """Open the tab of the editor's sidebar that has the add-on's panel."""
    ours = (getattr(bpy.types, name) for name in dir(bpy.types) if name.startswith("CRF_PT"))
    region(kind, "UI").active_panel_category = next(panel for panel in ours if panel.bl_space_type == kind).bl_category
    area(kind).tag_redraw()


def show_nodes() -> None:
    """Show the nodes of the scene's compositor in the node editor, with its first group active."""
    space = area("NODE_EDITOR").spaces.active
    scene = bpy.context.scene
    tree = scene.compositing_node_group if bpy.app.version >= (5, 0, 0) else scene.node_tree
    if bpy.app.version >= (5, 0, 0):
        space.node_tree = tree
    tree.nodes.active = next(node for node in tree.nodes if node.type == "GROUP")


def pan(x: float, y: float) -> None:
    """Enlarge the picture in the Image Editor three times, and move it by pixels of the image."""
    with context("IMAGE_EDITOR"):
        bpy.ops.image.view_zoom_ratio(ratio=3)
        bpy.ops.image.view_pan(offset=(x, y))


def view() -> list[float]:
    """Return the zoom of the Image Editor in percent, and where its picture begins and ends, in pixels."""
    found, place = area("IMAGE_EDITOR").spaces.active, region("IMAGE_EDITOR", "WINDOW").view2d
    corners = [place.view_to_region(*corner, clip=False) for corner in ((0, 0), (1, 1))]
    return [found.zoom_percentage, *corners[0], *corners[1]]


def switch(is_after: bool) -> float:
    """Switch between plate and linear plate; return how long that took in seconds."""
    started = time.perf_counter()
    with context("IMAGE_EDITOR"):
        bpy.ops.crf.compare(is_after=is_after)
    return time.perf_counter() - started


def redraw() -> None:
    """Redraw the whole window at the next event."""
    for found in window().screen.areas:
        found.tag_redraw()


def button(kind: str, of: str) -> str:
    """Return the Python command of the button under the mouse, or an empty text if there is none."""
    manager = bpy.context.window_manager
    manager.clipboard = ""
    with context(kind, of):
        if bpy.ops.ui.copy_python_command_button.poll():
            bpy.ops.ui.copy_python_command_button()
    return manager.clipboard


def change_workspace(name: str) -> str:
    """Show another workspace, and return the name of the one before."""
    before = window().workspace.name
    window().workspace = bpy.data.workspaces[name]
    return before
