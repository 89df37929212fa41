# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's preferences: choices that hold for every .blend file."""

from pathlib import Path

import bpy

#: The name by which Blender knows the add-on: that of its root package.
ADDON = __package__.rpartition(".")[0]

#: Entries of LUT files by default. It is `ocio.defaults.LUT_LENGTH` again, because `ocio` comes as a wheel, and the
#: add-on has to start without it.
LUT_LENGTH = 4081

#: The ways to apply a response, `work.job.ApplyMode`. The numbers at the end are stored in .blend files.
APPLY_MODES = (
    ("NODES", "Compositor Nodes", "A node group that linearises the plate in the compositor, at once", "NODETREE", 0),
    ("COLORSPACE", "Color Space", "A colour space in Blender's list, after one restart", "COLOR", 1),
    ("BAKE", "Bake", "Linear EXR files beside the plate, loaded into Blender", "FILE_IMAGE", 2),
    ("EXPORT", "Export Only", "LUT files and an OpenColorIO config for other programs", "EXPORT", 3),
)


class CRF_AddonPreferences(bpy.types.AddonPreferences):
    """Choices that hold for every .blend file."""

    bl_idname = ADDON

    model: bpy.props.StringProperty(
        name="Model",
        description="Folder with model.onnx and model.json; empty for the one in the add-on",
        subtype="DIR_PATH",
    )
    threads: bpy.props.IntProperty(
        name="Threads", description="Processor threads of the estimate; 0 for all", min=0, max=256
    )
    lut_length: bpy.props.IntProperty(
        name="LUT Length",
        description=f"Entries of LUT files: {LUT_LENGTH} is exact on all 8-bit codes, 65536 on all 16-bit codes",
        default=LUT_LENGTH,
        min=256,
        max=65536,
    )
    folder: bpy.props.StringProperty(
        name="Output Folder",
        description="Where baked and exported files go; empty for the plate's own folder",
        subtype="DIR_PATH",
    )
    apply: bpy.props.EnumProperty(name="Apply As", description="What the first estimate does", items=APPLY_MODES)

    def draw(self, _context: bpy.types.Context) -> None:
        """Draw the choices, and the button that restores an earlier OpenColorIO config."""
        layout = self.layout
        layout.use_property_split = True
        for name in ("model", "threads", "lut_length", "folder", "apply"):
            layout.prop(self, name)
        layout.operator("crf.restore_config", icon="LOOP_BACK")


def preferences() -> CRF_AddonPreferences:
    """Return the add-on's preferences."""
    return bpy.context.preferences.addons[ADDON].preferences


def absolute(folder: str) -> Path | None:
    """Return the path of a folder chosen in the interface, or None for an empty choice.

    Blender writes ``//`` for the folder of the .blend file.
    """
    return Path(bpy.path.abspath(folder)) if folder else None


def register() -> None:
    """Register the preferences."""
    bpy.utils.register_class(CRF_AddonPreferences)


def unregister() -> None:
    """Unregister the preferences."""
    bpy.utils.unregister_class(CRF_AddonPreferences)
