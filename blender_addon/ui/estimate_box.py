# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's box of an estimate, with the verdict in a word and the curve; warnings, and details on request."""

from __future__ import annotations

import math
import re
import textwrap

import bpy
import bpy.utils.previews

from ..scene import plates, stored_estimate
from ..work import curve_picture
from ..work.wording import says_too_little
from .image_editor.image_tools import CRF_OT_compare

#: The pictures of responses that were drawn, by the fingerprint of the estimate.
_previews: bpy.utils.previews.ImagePreviewCollection  # while the panels are registered

#: Each verdict in a word or two, with its icon and its meaning; and the same for other responses.
VERDICTS = {
    "usable": ("Usable", "INFO", "Look at the linear plate before you rely on it."),
    stored_estimate.DO_NOT_TRUST: ("Do not trust", "ERROR", ""),
    "mean": ("Mean of cameras", "QUESTION", "Usable only as that: the picture shows too little of its response."),
    "loaded": ("From a LUT", "FILE", ""),
    "copied": ("Copied", "DUPLICATE", "It is right only if the same camera took both, with the same settings."),
}

#: The axes and colors of the picture of the curve.
CAPTION = "Code value (a line every 64) by stops below white (every 2). Dashed: gamma 2.2."
BAND = " Blue: 90 % band."

#: The mean width of a letter, the borders of the panel and a box, and the width of an icon: pixels at a scale of 1.
_LETTER, _BORDER, _ICON = 6, 60, 20

#: The side of the picture of the curve, and the least and the largest side of the one in the details, in icons.
_SMALL, _LEAST, _LARGEST = 6, 9, 18

#: The distance of lines that belong together, relative to the distance of buttons.
_LINE = 0.75


class _Wrapper(textwrap.TextWrapper):
    """Breaks lines behind hyphens, colons and slashes, too, as in the options of a program."""

    wordsep_re = re.compile(r"(\s+|(?<=\w[-:/])(?=\w))")


def draw_estimate(layout: bpy.types.UILayout, context: bpy.types.Context, datablock: plates.Datablock) -> None:
    """Draw the verdict on the stored estimate of a plate, and its curve, in one box."""
    word, icon, meaning = _verdict_words(datablock)
    advice = stored_estimate.panel_paragraphs(datablock)[0]
    is_doubted = stored_estimate.verdict(datablock) == stored_estimate.DO_NOT_TRUST
    box = layout.box()
    column = box.column(align=True)
    row = column.row()
    row.alert = is_doubted
    row.label(text=word, icon=icon)
    has_switch = context.space_data.type == "IMAGE_EDITOR"
    draw_text(column, *advice, meaning if has_switch else "", stored_estimate.origin(datablock))
    if ffmpeg_filter := re.search(r"scale=[\w:=]+", " ".join(advice)):
        button = column.operator("wm.context_set_string", text="Copy the Filter", icon="COPYDOWN")
        button.data_path, button.value = "window_manager.clipboard", ffmpeg_filter[0]
    stops = stored_estimate.expected_stops(datablock)
    if math.isfinite(stops) and not is_doubted:
        draw_text(column, f"Expected error {stops:.2f} stop")
    box.template_icon(icon_value=curve_icon(datablock), scale=_SMALL)
    if has_switch:
        is_after = plates.compared_plate(context.space_data.image) is not None
        row = box.row(align=True)
        row.operator(CRF_OT_compare.bl_idname, text="Plate", depress=not is_after).is_after = False
        row.operator(CRF_OT_compare.bl_idname, text="Linear", depress=is_after).is_after = True


def draw_notices(layout: bpy.types.UILayout, datablock: plates.Datablock) -> None:
    """Draw the warnings of the stored estimate of a plate, and stored cameras."""
    draw_text(layout, *stored_estimate.panel_paragraphs(datablock)[2], icon="ERROR")
    if name := stored_estimate.camera(datablock):
        draw_text(layout, f"This is the response of the stored camera {name}.", icon="CAMERA_DATA")
        layout.operator("crf.estimate_response", text="Estimate from the Plate").camera = ""
    if offers := stored_estimate.offers(datablock):  # the most exact first
        name, words = offers[0]
        basis = re.sub(r" \([^()]*\)", "", words.removeprefix(f"{name}: "))
        others = " Others: Advanced > Camera." if offers[1:] else ""
        draw_text(layout, f"A response of this camera was {basis}.{others}", icon="CAMERA_DATA")
        layout.operator("crf.estimate_response", text=f"Use {name}").camera = name


def draw_details(layout: bpy.types.UILayout, datablock: plates.Datablock) -> None:
    """Draw the curve of the stored estimate as large as fits, and all sentences about it; closed at first."""
    header, body = layout.panel("CRF_details", default_closed=True)
    header.label(text="Details")
    if body is None:
        return
    body.template_icon(icon_value=curve_icon(datablock), scale=min(_LARGEST, max(_LEAST, _width() / _ICON)))
    is_band_seen = stored_estimate.has_verdict(datablock) and not stored_estimate.camera(datablock)
    draw_text(body, CAPTION + BAND * is_band_seen, *stored_estimate.panel_paragraphs(datablock)[1])


def _verdict_words(datablock: plates.Datablock) -> tuple[str, str, str]:
    """Return the verdict in a word or two, its icon, and its meaning or an empty text."""
    verdict = stored_estimate.verdict(datablock)
    if not stored_estimate.has_verdict(datablock):
        return VERDICTS["loaded"]
    if stored_estimate.origin(datablock) and verdict != stored_estimate.DO_NOT_TRUST:
        return VERDICTS["copied"]
    if says_too_little(verdict, stored_estimate.warning_codes(datablock)):
        return VERDICTS["mean"]
    return VERDICTS[verdict]


def draw_text(layout: bpy.types.UILayout, *texts: str, icon: str = "NONE") -> None:
    """Draw texts as paragraphs in lines that fit; an icon goes before each, and its other lines are indented."""
    width = max(20, int(_width() / _LETTER)) - (_ICON // _LETTER if icon != "NONE" else 0)
    for number, text in enumerate(filter(None, texts)):
        if number:
            layout.separator(factor=0.5)
        column = layout.column(align=True)
        column.scale_y = _LINE
        for part_number, part in enumerate(_Wrapper(width).wrap(text)):
            column.label(text=part, icon="BLANK1" if part_number and icon != "NONE" else icon)


def _width() -> float:
    """Return the width inside a box in the region that is drawn, in pixels at a scale of 1."""
    scale = bpy.context.preferences.system.ui_scale or 1  # 0 without a screen
    return bpy.context.region.width / scale - _BORDER


def curve_icon(datablock: plates.Datablock) -> int:
    """Return the icon of the picture of a stored response, which is drawn at the first call."""
    key = stored_estimate.fingerprint(datablock)
    if key not in _previews:
        preview = _previews.new(key)
        preview.image_size = (curve_picture.SIZE, curve_picture.SIZE)
        pixels = curve_picture.draw_response(*stored_estimate.curve_and_band(datablock))
        preview.image_pixels_float.foreach_set(pixels.ravel())
    return _previews[key].icon_id


def register() -> None:
    """Start with no picture drawn."""
    global _previews
    _previews = bpy.utils.previews.new()


def unregister() -> None:
    """Free the pictures."""
    bpy.utils.previews.remove(_previews)
