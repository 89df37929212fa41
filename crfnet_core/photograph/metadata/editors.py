"""Programs that edit or develop photographs, by the names that they write as EXIF Software and into the XMP history."""

import re
from collections.abc import Sequence

#: Programs that develop raw files to tones of their own; programs of camera makers imitate the camera.
DEVELOPERS = (
    *("lightroom", "camera raw", "capture one", "captureone", "darktable", "rawtherapee", "ufraw", "dcraw", "dxo"),
    *("photolab", "iridient", "aperture ", "phocus", "rawpower", "raw power", "photo ninja", "photoninja", "lightzone"),
    *("aftershot", "ansel", "filmulator", "vkdt"),
)

#: Programs that merge exposures, or map high dynamic range to tones that differ from place to place.
MERGERS = (
    *("photomatix", "easyhdr", "aurora hdr", "luminance hdr", "qtpfsgui", "hdr efex", "oloneo", "sns-hdr", "hdrsoft"),
    *("dynamic photo", "enfuse", "hdr projects"),
)

#: Parts of the names, in lower case. Each stands at the beginning of a word; firmware ("Ver.1.02", "HDR+ 1.0",
#: "Digital Camera X-E1 Ver2.00", "15.3.1", "G960USQS9FUG2") holds none of them.
EDITORS = (
    *DEVELOPERS,
    *MERGERS,
    *("adobe", "photoshop"),
    # raw developers of camera makers, and of the company behind some of them
    *("digital photo professional", "capture nx", "viewnx", "nx studio", "imaging edge", "image data converter"),
    *("olympus workspace", "olympus viewer", "olympus master", "olympus camedia", "om workspace", "photofunstudio"),
    *("silkypix", "raw file converter", "sigma photo pro", "x raw studio", "pentax digital camera utility"),
    # editors on computers
    *("gimp", "affinity", "pixelmator", "paint shop", "paintshop", "paint.net", "photoimpact", "photoscape", "corel"),
    *("luminar", "on1", "topaz", "skylum", "exposure x", "zoner", "acdsee", "krita", "imagemagick", "graphicsmagick"),
    *("irfanview", "xnview", "faststone", "picasa", "iphoto", "photos ", "digikam", "shotwell", "gthumb", "filmpack"),
    *("windows photo", "windows live photo", "microsoft photo", "photodirector", "movavi", "ashampoo", "magix"),
    *("perfectly clear", "nik collection", "color efex", "silver efex", "fotoxx", "photoline", "nuke", "davinci"),
    *("siril", "pixinsight"),  # of astronomers
    *("hugin", "ptgui", "autopano", "microsoft ice"),  # of panoramas
    # on phones and in the web
    *("snapseed", "vsco", "instagram", "picsart", "polarr", "pixlr", "befunky", "fotor", "meitu", "beautyplus", "b612"),
    *("samsung photo editor", "darkroom", "lightleap", "helicon focus"),
    *("camera360", "facetune", "afterlight", "prisma", "canva", "photopea", "faceapp", "remini", "touchretouch"),
)

#: Programs that only turn, label or wrap photographs, though their names look like names of editors; and `Software`, in
#: full, after a change in Google Photos or Picasa Web.
NO_EDITORS, EXACT = ("windows photo viewer", "adobe bridge", "dng converter"), ("google", "google photos")


def _any_of(names: Sequence[str]) -> re.Pattern[str]:
    """Return the pattern of any of these names at the beginning of a word."""
    return re.compile(r"(?<![a-z])(?:" + "|".join(map(re.escape, names)) + ")")


_EDITOR, _DEVELOPER, _MERGER = map(_any_of, (EDITORS, DEVELOPERS, MERGERS))


def editor_name(software: str, history: Sequence[str] = ()) -> str:
    """Return the editor that EXIF Software names, else the last one in the XMP history, or an empty text."""
    return next((name for name in (software, *reversed(history)) if is_editor(name)), "")


def is_editor(software: str) -> bool:
    """Return whether a program can change tones: firmware and mere viewers cannot."""
    name = software.casefold()
    if any(part in name for part in NO_EDITORS):
        return False
    return name in EXACT or bool(_EDITOR.search(name))


def is_developer(software: str) -> bool:
    """Return whether a program is mostly used to develop raw files, to tones other than the camera's."""
    return bool(_DEVELOPER.search(software.casefold()))


def is_merger(software: str) -> bool:
    """Return whether a program merges exposures, so that no response explains its pictures."""
    return bool(_MERGER.search(software.casefold()))
