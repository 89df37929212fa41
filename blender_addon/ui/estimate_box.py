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
    "loaded": ("Loaded", "FILE", ""),
    "copied": ("Copied", "DUPLICATE", "It is right only if the same camera took both, with the same settings."),
}

#: The axes and colors of the picture of the curve.
CAPTION = "Code value (a line every 64) by stops below white (every 2). Blue: 90 % band. Dashed: gamma 2.2."

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
    letters = letters_of(context)
    word, icon, meaning = _verdict_words(datablock)
    advice = stored_estimate.panel_paragraphs(datablock)[0]
    is_doubted = stored_estimate.verdict(datablock) == stored_estimate.DO_NOT_TRUST
    box = layout.box()
    column = box.column(align=True)
    row = column.row()
    row.alert = is_doubted
    row.label(text=word, icon=icon)
    for text in (*advice, meaning, stored_estimate.origin(datablock)):
        draw_text(column, text, letters)
    if ffmpeg_filter := re.search(r"scale=[\w:=]+", " ".join(advice)):
        button = column.operator("wm.context_set_string", text="Copy the Filter", icon="COPYDOWN")
        button.data_path, button.value = "window_manager.clipboard", ffmpeg_filter[0]
    stops = stored_estimate.expected_stops(datablock)
    if math.isfinite(stops) and not is_doubted:
        draw_text(column, f"Expected error {stops:.2f} stop", letters)
    box.template_icon(icon_value=curve_icon(datablock), scale=_SMALL)
    if context.space_data.type == "IMAGE_EDITOR":
        is_after = plates.compared_plate(context.space_data.image) is not None
        row = box.row(align=True)
        row.operator(CRF_OT_compare.bl_idname, text="Plate", depress=not is_after).is_after = False
        row.operator(CRF_OT_compare.bl_idname, text="Linear", depress=is_after).is_after = True


def draw_notices(layout: bpy.types.UILayout, context: bpy.types.Context, datablock: plates.Datablock) -> None:
    """Draw the warnings of the stored estimate of a plate, and stored cameras."""
    letters = letters_of(context)
    draw_paragraphs(layout, stored_estimate.panel_paragraphs(datablock)[2], letters, icon="ERROR")
    if name := stored_estimate.camera(datablock):
        draw_text(layout, f"This is the response of the stored camera {name}.", letters, icon="CAMERA_DATA")
        layout.operator("crf.estimate_response", text="Estimate from the Plate").camera = ""
    for name, words in stored_estimate.offers(datablock):
        draw_text(layout, words, letters, icon="CAMERA_DATA")
        layout.operator("crf.estimate_response", text=f"Use {name}").camera = name


def draw_details(layout: bpy.types.UILayout, context: bpy.types.Context, datablock: plates.Datablock) -> None:
    """Draw the curve of the stored estimate as large as fits, and all sentences about it; closed at first."""
    header, body = layout.panel("CRF_details", default_closed=True)
    header.label(text="Details")
    if body is None:
        return
    letters, side = letters_of(context), _width(context) / _ICON
    body.template_icon(icon_value=curve_icon(datablock), scale=min(_LARGEST, max(_LEAST, side)))
    draw_text(body, CAPTION, letters)
    draw_paragraphs(body, stored_estimate.panel_paragraphs(datablock)[1], letters)


def _verdict_words(datablock: plates.Datablock) -> tuple[str, str, str]:
    """Return the verdict in a word or two, its icon, and its meaning or an empty text."""
    verdict = stored_estimate.verdict(datablock)
    if not stored_estimate.has_verdict(datablock):
        return VERDICTS["loaded"]
    if stored_estimate.origin(datablock) and verdict != stored_estimate.DO_NOT_TRUST:
        return VERDICTS["copied"]
    if says_too_little(verdict, stored_estimate.warning_codes(datablock)):
        return VERDICTS["mean"]
    word, icon, meaning = VERDICTS[verdict]
    kind = stored_estimate.recognized_as(datablock)
    return f"{word}: {kind}" if kind else word, icon, meaning


def draw_paragraphs(layout: bpy.types.UILayout, lines: list[str], letters: int, *, icon: str = "NONE") -> None:
    """Draw lines as paragraphs in one column, each with an icon; nothing if there are none."""
    column = layout.column(align=True)
    for number, line in enumerate(lines):
        if number:
            column.separator(factor=0.5)
        draw_text(column, line, letters, icon=icon)


def draw_text(layout: bpy.types.UILayout, text: str, letters: int, *, icon: str = "NONE") -> None:
    """Draw a text in lines that fit; an icon goes before the first, and the others are indented by as much."""
    column = layout.column(align=True)
    column.scale_y = _LINE
    width = letters - (_ICON // _LETTER if icon != "NONE" else 0)
    for number, part in enumerate(_Wrapper(width).wrap(text)):
        column.label(text=part, icon=icon if not number or icon == "NONE" else "BLANK1")


def letters_of(context: bpy.types.Context) -> int:
    """Return how many letters fit into a line of a box in the region; at least 20."""
    return max(20, int(_width(context) / _LETTER))


def _width(context: bpy.types.Context) -> float:
    """Return the width inside a box in the region, in pixels at a scale of 1."""
    scale = context.preferences.system.ui_scale or 1  # 0 without a screen
    return context.region.width / scale - _BORDER


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
