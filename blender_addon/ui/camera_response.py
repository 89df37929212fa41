# SPDX-License-Identifier: GPL-3.0-or-later
"""The stored response of an image or clip, as scripts read it: `image.camera_response`.

Its getters read the custom property of the same name, which Blender 4.5 takes for the storage of this group.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from ..scene import stored_estimate
from .plate_settings import is_applied, plate_property_factory

if TYPE_CHECKING:
    from crfnet_core.types import Float64Array


def _getter(read: Callable[[bpy.types.ID], Any], otherwise: Any) -> Callable[[bpy.types.PropertyGroup], Any]:
    """Return a getter that reads from the image or clip, or returns another value if that has no response."""
    return lambda group: read(group.id_data) if stored_estimate.is_stored(group.id_data) else otherwise


class CRF_CameraResponse(bpy.types.PropertyGroup):
    """The response of an image or clip, read-only; without a response it is empty."""

    is_stored: bpy.props.BoolProperty(description="Whether there is a response", get=_getter(lambda _: True, False))
    verdict: bpy.props.StringProperty(
        description='"usable" or "do not trust"; empty for a response from a LUT',
        get=_getter(lambda plate: stored_estimate.verdict(plate) if stored_estimate.has_verdict(plate) else "", ""),
    )
    expected_error: bpy.props.FloatProperty(
        description="The expected error of the linear light in stops; NaN for a response from a LUT",
        get=_getter(stored_estimate.expected_stops, 0.0),
    )
    is_applied: bpy.props.BoolProperty(
        description="Whether the response is applied with the present settings", get=_getter(is_applied, False)
    )
    exposure: bpy.props.FloatProperty(
        description="The exposure of the linear plate in stops, the anchor's included",
        get=_getter(stored_estimate.exposure, 0.0),
    )
    camera: bpy.props.StringProperty(
        description="The name of the stored camera whose response it is; empty if it was estimated",
        get=_getter(stored_estimate.camera, ""),
    )
    origin: bpy.props.StringProperty(
        description='Such as "From one.png" or "Loaded from a.cube"; empty if it was estimated from the plate',
        get=_getter(stored_estimate.origin, ""),
    )

    @property
    def warnings(self) -> tuple[str, ...]:
        """The codes of the warnings, such as "clipped"."""
        return tuple(stored_estimate.warning_codes(self.id_data)) if self.is_stored else ()

    @property
    def curve(self) -> "Float64Array":
        """The code values, from 0 to 1, at equal steps of linear light from 0 to 1, shape (1024,)."""
        return stored_estimate.curve_and_band(self.id_data)[0] if self.is_stored else np.empty(0)


register, unregister = plate_property_factory("camera_response", CRF_CameraResponse)
