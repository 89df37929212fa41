# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's preferences: choices for every .blend file."""

from pathlib import Path

import bpy

from ..work.errors import AddonError

#: The name by which Blender knows the add-on: the name of its root package.
ADDON = __package__.rpartition(".")[0]

#: The ways to apply a response, as in `work.job.ApplyMode`.
APPLY_MODES = (
    ("NODES", "Nodes", "At once: a node group linearizes the plate, in the compositor or the shader shown"),
    ("BAKE", "Bake", "Write linear EXR files next to the plate, and load them"),
    ("EXPORT", "Export", "Write LUTs, and a copy of Blender's OpenColorIO config with a color space for the plate"),
)

#: The properties of a folder that the user chooses.
FOLDER = {"subtype": "DIR_PATH", "options": {"PATH_SUPPORTS_BLEND_RELATIVE"}}


class CRF_AddonPreferences(bpy.types.AddonPreferences):
    """Choices that hold for every .blend file."""

    bl_idname = ADDON

    model: bpy.props.StringProperty(
        name="Model",
        description="Folder of another model, with model.onnx and model.json. Empty: the model in the add-on",
        **FOLDER,
    )
    folder: bpy.props.StringProperty(
        name="Output Folder", description="Folder for baked and exported files. Empty: the plate's own folder", **FOLDER
    )
    apply_as: bpy.props.EnumProperty(
        name="Apply As",
        description="The way to apply the response of a new plate: the one that was chosen last",
        items=APPLY_MODES,
    )

    def draw(self, _context: bpy.types.Context) -> None:
        """Draw the choices."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "apply_as")
        layout.prop(self, "folder", placeholder="The plate's own folder")
        layout.prop(self, "model", placeholder="The add-on's own model")
        button = layout.operator("wm.path_open", text="Documentation", icon="HELP")
        button.filepath = str(Path(__file__).parents[1] / "README.md")


def preferences() -> CRF_AddonPreferences:
    """Return the add-on's preferences."""
    return bpy.context.preferences.addons[ADDON].preferences


def absolute(path: str) -> Path | None:
    """Return the path of a file or folder chosen in the interface, or None for an empty choice."""
    if path.startswith("//") and not bpy.data.filepath:  # Blender's sign for the folder of the .blend file
        raise AddonError(f"{path} is relative to the .blend file: save that first, or choose another path")
    return Path(bpy.path.abspath(path)) if path else None


register, unregister = bpy.utils.register_classes_factory((CRF_AddonPreferences,))
