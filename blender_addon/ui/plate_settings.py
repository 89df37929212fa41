# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of one plate, stored on its image or clip and so in the .blend file."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import bpy

from .. import lazy_import
from ..scene import plates, stored_estimate
from ..scene.nodes import compositor
from ..scene.nodes.ready_comp import is_plain
from ..work.errors import AddonError
from ..work.job import WITHOUT_FILES
from .image_editor import comparison
from .preferences import APPLY_MODES, FOLDER, preferences

if TYPE_CHECKING:
    from ..work.run import CompletedJob

#: The anchors of the exposure, `work.job.Anchor`.
ANCHORS = (
    ("WHITE", "White", "Code value 1 becomes a linear 1"),
    ("GRAY", "Middle Gray", "The gray brightness below becomes a linear 0.18"),
)

#: The samples of linear EXR files.
DEPTHS = (
    ("half", "Half", "16-bit floats: smaller files, 11 bits of precision"),
    ("float", "Float", "32-bit floats: exact"),
)

#: The kinds of responses to expect: `crfnet.defaults.PRIORS`.
PRIORS = (
    ("camera", "Camera", "Today's phones, compact cameras and cameras with interchangeable lenses, mostly unedited"),
    ("any", "Any Source", "Also film scans, old video cameras and heavily edited pictures, as likely as cameras"),
)

#: The device that took the plate: from its file, or one of `crfnet.defaults.DEVICES`.
DEVICES = (
    ("file", "As the File Says", "Frames and pictures from web pages mostly say nothing: then choose, if you know"),
    ("phone", "Phone", "A phone or a tablet"),
    ("compact", "Compact Camera", "A camera whose lens cannot be changed"),
    ("camera", "Reflex or Mirrorless", "A camera with interchangeable lenses"),
    ("other", "Other Camera", "A camera of another kind, such as a drone, or of a kind that you do not know"),
)

#: Largest exposure in either direction, in stops: `crfnet.defaults.MAX_EXPOSURE`, without importing the wheel.
MAX_EXPOSURE = 15

#: The names of the ways to apply a response, by the order of their enumeration.
_MODES = [item[0] for item in APPLY_MODES]

#: The entries of a stored estimate with the settings that were applied last, and with the config exported by them.
APPLIED, CONFIG = "applied_settings", "exported_config"


def _stored_cameras(chosen: bpy.types.bpy_struct, _: bpy.types.Context, text: str) -> list[tuple[str, str]]:
    """Return the stored cameras that hold a text, the plate's model first; none without the wheels."""
    datablock = chosen.id_data
    models = stored_estimate.camera_models(datablock) if stored_estimate.is_stored(datablock) else ()
    try:
        return lazy_import.load("crfnet_core.library").listed_cameras(text, models)
    except AddonError:
        return []


def _expose(settings: bpy.types.bpy_struct, _: bpy.types.Context) -> None:
    """Give the nodes of a plate that has been applied as nodes the exposure of its settings, and its linear view."""
    comparison.renew_soon()
    plate = settings.id_data
    applied = plate[stored_estimate.KEY].get(APPLIED) if stored_estimate.is_stored(plate) else None
    if applied is None or applied["apply"] != "NODES":
        return
    stops = stored_estimate.exposure(plate) + settings.exposure - applied["exposure"]
    stored_estimate.set_entry(plate, stored_estimate.EXPOSURE, stops)
    applied["exposure"] = settings.exposure
    compositor.set_exposure(plate, bpy.context.scene, stops)


class PlateChoices:
    """The choices for a plate that the panel offers and the operators take as arguments."""

    anchor: bpy.props.EnumProperty(
        name="Anchor", description="Which brightness gets a fixed linear value, which no response gives", items=ANCHORS
    )
    gray: bpy.props.FloatProperty(
        name="Gray",
        description="The encoded brightness, as seen in the plate, of something that reflects 18 % of the light",
        default=118 / 255,
        min=0.01,
        max=1.0,
        precision=3,
    )
    exposure: bpy.props.FloatProperty(
        name="Exposure",
        description="Stops added on top of the anchor. The nodes of an applied response follow at once",
        soft_min=-6,
        soft_max=6,
        min=-MAX_EXPOSURE,
        max=MAX_EXPOSURE,
        update=_expose,
    )
    compose: bpy.props.BoolProperty(
        name="Compose Render over Plate", description="Put the render over a plate that no node shows yet"
    )
    folder: bpy.props.StringProperty(
        name="Folder",
        description="Folder for new files. Empty: the folder of the preferences, of the plate or of the .blend file",
        **FOLDER,
    )
    depth: bpy.props.EnumProperty(name="Depth", description="Samples of the baked EXR files", items=DEPTHS)
    overwrite: bpy.props.BoolProperty(
        name="Overwrite", description="Replace files that are not of this plate; is asked anew each time"
    )
    force: bpy.props.BoolProperty(
        name="Estimate Anyway",
        description="Estimate even if the color space or the metadata says that the plate is logarithmic or linear."
        " OpenEXR files are never estimated: where they do not say what they hold, a response from a LUT or another"
        " plate then takes them for encoded",
    )
    camera: bpy.props.StringProperty(
        name="Camera",
        description="A stored camera, whose measured response is used. Empty: estimated from the plate",
        search=_stored_cameras,
    )
    prior: bpy.props.EnumProperty(
        name="Expect", description="Which kinds of responses are likely before the plate is looked at", items=PRIORS
    )
    device: bpy.props.EnumProperty(
        name="Taken With", description="What took the plate, where you know it and its file does not say", items=DEVICES
    )
    ignore_metadata: bpy.props.BoolProperty(
        name="Ignore Metadata", description="Do not use the camera and the editing programs that the file names"
    )


#: The names of all choices; the panel and the operators differ in how they define `apply`.
CHOICES = ("apply", *PlateChoices.__annotations__)


def _choice(settings: bpy.types.PropertyGroup) -> int:
    """Return how to apply the response of a plate: as chosen for it or last; movies are not baked."""
    mode = settings.chosen if settings.chosen in _MODES else preferences().apply_as
    return _MODES.index("NODES" if mode == "BAKE" and settings.id_data.source == "MOVIE" else mode)


def _choose(settings: bpy.types.PropertyGroup, number: int) -> None:
    """Choose how to apply the response of a plate, and of plates for which nothing is chosen yet."""
    settings.chosen = preferences().apply_as = _MODES[number]
    bpy.context.preferences.is_dirty = True  # Blender saves them when it quits


class CRF_PlateSettings(PlateChoices, bpy.types.PropertyGroup):
    """The settings of one plate; until `apply` is set, the preferences count, and the compositor for `compose`."""

    chosen: bpy.props.StringProperty(options={"HIDDEN"})
    chosen_comp: bpy.props.IntProperty(options={"HIDDEN"}, default=-1)
    apply: bpy.props.EnumProperty(
        name="Apply As",
        description="What becomes of the response",
        items=APPLY_MODES,
        get=_choice,
        set=_choose,
    )
    compose: bpy.props.BoolProperty(
        name="Compose Render over Plate",
        description="Scale the plate to the render, and put all that went to the output over it, with a transparent"
        " film. On at first unless the compositor has nodes of yours",
        get=lambda self: (
            is_plain(compositor.tree_shown_in(bpy.context)) if self.chosen_comp < 0 else bool(self.chosen_comp)
        ),
        set=lambda self, is_wanted: setattr(self, "chosen_comp", int(is_wanted)),
    )


def remember_applied(datablock: bpy.types.ID, completed: "CompletedJob") -> None:
    """Remember on a plate with an estimate that its present settings have been applied, and the exported config."""
    stored_estimate.set_entry(datablock, APPLIED, _comparable(datablock.camera_response_settings))
    config = completed.files and completed.files.config
    stored_estimate.set_entry(datablock, CONFIG, str(config or ""))


def exported_config(datablock: bpy.types.ID) -> str:
    """Return the config that was exported for a plate with an estimate last; an empty text if it is not known."""
    return datablock[stored_estimate.KEY].get(CONFIG, "")


def is_applied(datablock: bpy.types.ID) -> bool:
    """Return whether the estimate of a plate is applied with its present settings; in this scene, if as nodes."""
    if APPLIED not in datablock[stored_estimate.KEY] or is_to_be_applied(datablock):
        return False
    return datablock.camera_response_settings.apply != "NODES" or compositor.is_linearized(datablock, bpy.context)


def is_to_be_applied(datablock: bpy.types.ID) -> bool:
    """Return whether a plate's settings are others than those applied last, or the exposure of its nodes is another.

    A full copy of a scene has nodes, and so an exposure, of its own.
    """
    applied = datablock[stored_estimate.KEY].get(APPLIED)
    if applied is None or applied.to_dict() != _comparable(datablock.camera_response_settings):
        return applied is not None
    exposure = stored_estimate.exposure(datablock)
    return not compositor.has_exposure(datablock, bpy.context.scene, exposure)


def _comparable(settings: CRF_PlateSettings) -> dict[str, str | float]:
    """Return the settings that change what is applied."""
    names = ["apply", "anchor", "exposure"]
    names += ["gray"] if settings.anchor == "GRAY" else []
    names += ["depth"] if settings.apply == "BAKE" else []
    names += ["folder"] if settings.apply not in WITHOUT_FILES else []
    chosen = {name: getattr(settings, name) for name in names}
    if settings.apply in ("NODES", "BAKE"):  # which go by the setting of the image
        chosen["alpha"] = plates.alpha_mode(settings.id_data)
    return chosen


def plate_property_factory(name: str, group: type[bpy.types.PropertyGroup]) -> tuple[Callable[[], None], ...]:
    """Return functions that add a group of properties to images and clips under a name, and remove it."""
    kinds = (bpy.types.Image, bpy.types.MovieClip)

    def register() -> None:
        bpy.utils.register_class(group)
        for kind in kinds:
            setattr(kind, name, bpy.props.PointerProperty(type=group))

    def unregister() -> None:
        for kind in kinds:
            delattr(kind, name)
        bpy.utils.unregister_class(group)

    return register, unregister


register, unregister = plate_property_factory("camera_response_settings", CRF_PlateSettings)
