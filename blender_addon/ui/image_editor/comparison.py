# SPDX-License-Identifier: GPL-3.0-or-later
"""Show the linear plate instead of the plate in an Image Editor, and go back.

The linear plate is a hidden image, whose file is in Blender's folder for this session: pixels in memory alone would
count as unsaved. It is kept for the next switch until the file is saved or opened, or something is undone.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ... import lazy_import
from ...scene import stored_estimate
from ...scene.color_management import running_config
from ...scene.nodes import compositor
from ...scene.plates import COMPARED_PLATE, alpha_mode, compared_plate, file_state, plate_itself, plate_of
from ...work.errors import AddonError, expected_errors

if TYPE_CHECKING:
    from crfnet_core import ResponseCurve
    from crfnet_core.types import Float32Array, Float64Array

_KEY = "camera_response_key"  # the custom property of these images with the key of their pixels
_LARGEST = 65535  # code value of the look-up table: a multiple of 255, so it is exact on 8 and on 16 bits
_ROWS = 16  # that are converted at a time: few enough to stay in the processor's cache
_PAUSE = 0.2  # seconds after a change of exposure or frame until linear plates show it: no slider or player waits


def begin(space: bpy.types.SpaceImageEditor, pixels: Float32Array, color_space: str, key: str) -> None:
    """Show the linear plate in an editor that shows the plate; the `key` finds it again.

    Its pixels are as of `linear_pixels`, in a color space. Raise AddonError if there is no room for its file.
    """
    plate, path = space.image, Path(bpy.app.tempdir, f"linear_{space.image.session_uid}.exr")
    buffer = lazy_import.load("OpenImageIO").ImageBuf(np.ascontiguousarray(pixels[::-1]))
    buffer.specmod().attribute("compression", "none")
    if not buffer.write(str(path)):
        raise AddonError(f"{path}: cannot be written: {buffer.geterror()}")
    linear = _linear_image(plate) or bpy.data.images.load(str(path))
    linear.name = f".Linear view of {plate.name}"  # a leading dot hides it in menus
    linear[COMPARED_PLATE], linear[_KEY] = plate, key
    linear.colorspace_settings.name = color_space
    linear.reload()
    space.image = linear


def _linear_image(plate: bpy.types.Image) -> bpy.types.Image | None:
    """Return the linear plate of a plate, of whatever key."""
    return next((image for image in bpy.data.images if compared_plate(image) == plate), None)


def end(space: bpy.types.SpaceImageEditor) -> None:
    """Show the plate again in an editor that shows its linear one, or its code values for the compositor."""
    if space.image is not None:
        space.image = compared_plate(space.image) or plate_itself(space.image)


@contextmanager
def same_view(context: bpy.types.Context) -> Iterator[None]:
    """Keep zoom and position of an Image Editor while it changes to another image: Blender has them for each image."""
    space = context.space_data
    if space is None or space.type != "IMAGE_EDITOR" or space.image is None:
        yield
        return
    region = _picture_region(context.area)
    zoom, size = space.zoom_percentage, tuple(space.image.size)  # which Blender does not know yet of a new sequence
    center = region.view2d.region_to_view(region.width / 2, region.height / 2)
    yield
    if not all(map(math.isfinite, center)):  # it was never drawn
        return
    # in whole pixels of the image, so that the half one by which Blender misses the center does not add up
    offset = [math.floor((at - 0.5) * side + 0.25) for at, side in zip(center, size, strict=True)]
    with context.temp_override(region=region):
        bpy.ops.image.view_all()
        space.zoom_percentage = zoom
        bpy.ops.image.view_pan(offset=offset)


def frame_view(context: bpy.types.Context) -> None:
    """Show the whole picture of an Image Editor that has another size than before."""
    update_frame(context.space_data.image_user)
    with context.temp_override(region=_picture_region(context.area)):
        bpy.ops.image.view_all()


def _picture_region(area: bpy.types.Area) -> bpy.types.Region:
    """Return the region of an Image Editor that shows the picture."""
    return next(region for region in area.regions if region.type == "WINDOW")


def end_all() -> None:
    """Show the plates again everywhere, and remove all linear plates that were only shown."""
    for space in _image_editors():
        if space.image is not None and COMPARED_PLATE in space.image:
            space.image = compared_plate(space.image)
    bpy.data.batch_remove([image for image in bpy.data.images if COMPARED_PLATE in image])


def is_frame_shown() -> bool:
    """Return whether an editor shows the linear plate of a sequence or movie."""
    plates = (compared_plate(space.image) for space in _image_editors())
    return any(plate is not None and plate.source != "FILE" for plate in plates)


def renew_soon() -> None:
    """Call `renew` once this has not been called for a moment."""
    with suppress(ValueError):  # none is waiting
        bpy.app.timers.unregister(renew)
    bpy.app.timers.register(renew, first_interval=_PAUSE)


def renew() -> None:
    """Show linear plates with the present exposure and at the present frame, where they are shown."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR" and compared_plate(area.spaces.active.image) is not None:
                with bpy.context.temp_override(window=window, area=area), same_view(bpy.context):
                    _renew_in(area.spaces.active)
                area.tag_redraw()


def _renew_in(space: bpy.types.SpaceImageEditor) -> None:
    """Show the present linear plate in an editor; of a missing frame an empty picture, until one that exists."""
    linear = space.image
    end(space)
    try:
        show_linear(space)
    except expected_errors():
        if space.image.source != "FILE":
            width, height = linear.size
            begin(space, np.zeros((height, width, 4), np.float32), linear.colorspace_settings.name, key="")


def show_linear(space: bpy.types.SpaceImageEditor) -> None:
    """Show the linear plate of what an editor shows, by the stored response and the present exposure.

    Raise AddonError or CRFNetError if the plate cannot be read, or there is no room for a file.
    """
    plate, user = space.image, space.image_user
    settings, curve = plate.camera_response_settings, stored_estimate.restored(plate).curve
    gray = settings.gray if settings.anchor == "GRAY" else None
    stops = lazy_import.load("crfnet.pipeline").anchored_exposure(curve, gray=gray, stops=settings.exposure)
    key, linear = _key(plate, stops), _linear_image(plate)
    if linear is not None and key and linear[_KEY] == key:
        space.image = linear
        return
    update_frame(user)
    pixels = linear_pixels(code_values(plate, user), curve, stops, stored_estimate.matrix(plate))
    begin(space, pixels, lazy_import.load(".scene.nodes.plate_group").linear_rec709(), key)


def update_frame(user: bpy.types.ImageUser) -> None:
    """Give an editor's sequence its present frame, which Blender does only where it draws the sequence itself."""
    if user.use_auto_refresh:
        timing = compositor.FrameTiming.from_user(user)
        user.frame_current = timing.number_on(bpy.context.scene.frame_current)


def _key(plate: bpy.types.Image, stops: float) -> str:
    """Return a text that differs between linear plates; an empty one for frames, and for painted pixels."""
    details = (stored_estimate.fingerprint(plate), stops, alpha_mode(plate), stored_estimate.primaries(plate))
    packed = plate.packed_file
    state = hash(packed.data) if packed else file_state(plate)
    return f"{state} {details}" if state and plate.source == "FILE" else ""


def code_values(image: bpy.types.Image, user: bpy.types.ImageUser) -> Float32Array:
    """Return the code values of an image, of the frame that an editor shows: float32, shape (H, W, 3 or 4), in [0, 1].

    They are as in an estimate and a bake. The bottom row comes first, and colors are not multiplied by alpha, which
    is left out where Blender does not take it for coverage. Raise AddonError or CRFNetError if the image cannot be
    read, or does not hold encoded values.
    """
    frame_files, encoding_check = lazy_import.load(".work.frame_files"), lazy_import.load(".work.encoding_check")
    plate = plate_of(image, is_only_read=True)
    is_forced = image.camera_response_settings.force
    is_encoded = encoding_check.holds_encoded_values(plate, running_config(), is_forced=is_forced)
    with frame_files.frame_reader(plate) as read:
        shown = Path(bpy.path.abspath(image.filepath_from_user(image_user=user), library=image.library))
        is_frame = image.source == "SEQUENCE"
        (path,) = read(frame_files.FrameSequence((shown,)) if is_frame else frame_files.frames_of(plate)).paths
        frame = frame_files.read_plate_frame(path, plate.alpha_mode, is_encoded=is_encoded)
    channels = [frame.samples / np.float32(frame.largest)]
    if frame.alpha is not None and frame.is_coverage:
        channels.append(frame.alpha[..., None])
    return np.clip(np.concatenate(channels, axis=2, dtype=np.float32), 0, 1)[::-1]


def linear_pixels(
    codes: Float32Array, curve: ResponseCurve, stops: float, matrix: Float64Array | None = None
) -> Float32Array:
    """Return the linear plate, float32, shape (H, W, 4), in linear Rec.709 and multiplied by alpha.

    `codes` are as `code_values` returns them; the matrix, shape (3, 3), leads from the plate's linear RGB to Rec.709.
    """
    table = (curve.inverse(np.arange(_LARGEST + 1) / _LARGEST) * 2**stops).astype(np.float32)
    linear = np.empty((*codes.shape[:2], 4), np.float32)
    for start in range(0, len(codes), _ROWS):
        rows = slice(start, start + _ROWS)
        index = (codes[rows] * _LARGEST + 0.5).astype(np.uint16)  # with alpha, too: one run of memory is faster
        linear[rows, :, :3] = np.take(table, index)[..., :3]
        if matrix is not None:
            linear[rows, :, :3] = linear[rows, :, :3] @ matrix.T
        linear[rows, :, 3:] = codes[rows, :, 3:] if codes.shape[2] == 4 else 1
        if linear[rows, :, 3].min() < 1:
            linear[rows, :, :3] *= linear[rows, :, 3:]
    return linear


def _image_editors() -> Iterator[bpy.types.SpaceImageEditor]:
    """Yield the Image Editors of all workspaces."""
    for screen in bpy.data.screens:
        for area in screen.areas:
            yield from (space for space in area.spaces if space.type == "IMAGE_EDITOR")
