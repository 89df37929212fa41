"""The limited range of video, stored as if it were full: black at code 16 of 255 and white at 235."""

from __future__ import annotations

from crfnet_core.photograph.recognition.levels import Levels

#: Black and white of limited range (ITU-R BT.709, item 6: codes of 8 bits), as brightness.
LIMITED_BLACK, LIMITED_WHITE = 16 / 255, 235 / 255

#: How far around them samples count as black or white: three codes.
MARGIN = 3 / 255

#: The largest fraction of samples outside, and the least fraction at either end.
MOST_OUTSIDE, LEAST_AT_END = 0.002, 1e-4

#: The fraction of pixels with a luma beyond black and white, and between which codes these two lie after compression.
BEYOND, BLACKS, WHITES = 1e-4, (8 / 255, 20 / 255), (231 / 255, 245 / 255)

#: The largest fraction of samples above the codes of white: channels of bright, saturated colors go beyond their luma.
MOST_ABOVE = 0.01

_BAND = 2 * MARGIN + 1 / 255


def is_limited_range(levels: Levels) -> bool:
    """Return whether a picture has the histogram of limited range: Eq. L.2 of docs/METHOD.md.

    Either hardly a sample lies outside the codes 16 to 235, both ends are reached, and at one end at least samples pile
    up, as clipped highlights and shadows do; or black and white of luma lie where limited range has them. Of 92 real
    photographs 12 have such a black and 3 such a white, none both.
    """
    return _has_piles(levels) or _has_ends(levels)


def _has_ends(levels: Levels) -> bool:
    """Return whether black and white lie near 16 and 235. JPEG compression blurs piles, and least of all in luma."""
    black, white = levels.luma_quantile(BEYOND), levels.luma_quantile(1 - BEYOND)
    has_ends = BLACKS[0] <= black <= BLACKS[1] and WHITES[0] <= white <= WHITES[1]
    return has_ends and levels.fraction(LIMITED_WHITE + _BAND, 1) <= MOST_ABOVE


def _has_piles(levels: Levels) -> bool:
    """Return whether the samples end at the codes 16 and 235, and pile up at one of them."""
    below, above = levels.fraction(0, LIMITED_BLACK - _BAND / 2), levels.fraction(LIMITED_WHITE + _BAND / 2, 1)
    dark, bright = _end(levels, LIMITED_BLACK), _end(levels, LIMITED_WHITE)
    inside_dark = levels.fraction(LIMITED_BLACK + _BAND / 2, LIMITED_BLACK + 1.5 * _BAND)
    inside_bright = levels.fraction(LIMITED_WHITE - 1.5 * _BAND, LIMITED_WHITE - _BAND / 2)
    is_inside, is_reached = max(below, above) <= MOST_OUTSIDE, min(dark, bright) >= LEAST_AT_END
    return is_inside and is_reached and (dark > inside_dark or bright > inside_bright)


def _end(levels: Levels, end: float) -> float:
    """Return the fraction of the samples at one end."""
    return levels.fraction(end - MARGIN, end + MARGIN)
