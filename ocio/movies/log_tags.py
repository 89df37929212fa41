"""What makers write of their log curves into movies and beside them, apart from what streams can tag.

Apple: the box `logs` of the sample description holds the identifier of Core Video's kCVImageBufferLogTransferFunction.
Sony: the XML of XAVC and MXF files (non-real-time metadata) has the item CaptureGammaEquation; cameras write the same
XML beside C0001.MP4 as C0001M01.XML.
Panasonic: the XML of QuickTime's key com.panasonic.Semi-Pro.metadata.xml has the element CaptureGamma.
DJI: the captions beside DJI_0001.MP4, DJI_0001.SRT, have color_md. D-Log M, which has no published curve, is left out.
ARRI: QuickTime metadata com.arri.camera.ColorGammaSxS.
"""

from __future__ import annotations

import mmap
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from .library import QUICKTIME_BOXES

#: Texts in a movie, outside of its pictures, or beside it -> the log curve that they name.
TEXTS = {
    rb"com\.apple\.rec2020\.apple-log": "Apple Log",
    rb"com\.apple\.apple-wide-gamut\.apple-log": "Apple Log 2",
    rb'"CaptureGammaEquation"\s+value="s-log3-cine"': "Sony S-Log3",
    rb'"CaptureGammaEquation"\s+value="s-log3"': "Sony S-Log3 in S-Gamut3",
    rb'"CaptureGammaEquation"\s+value="s-log2"': "Sony S-Log2",
    rb"<CaptureGamma>\s*V-Log\s*</CaptureGamma>": "Panasonic V-Log",
    rb"\[color_md ?: ?d_?log\]": "DJI D-Log",
}

#: ARRI's key, in lower case, and how its value begins for LogC3.
ARRI_KEY, ARRI_LOG, ARRI_CURVE = "com.arri.camera.colorgammasxs", "LOG-C", "ARRI LogC3"

#: What follows a movie's name, without its suffix, in the names of the files beside it.
SIDECARS = ("M01.XML", ".SRT")

#: Bytes at either end of a file in which texts are looked for where it has no boxes.
_ENDS = 1 << 20

#: Bytes of a box in which texts are looked for: the index of an hour of frames is smaller.
_LARGEST = 1 << 25


def log_curve(path: Path, metadata: Mapping[str, str]) -> str:
    """Return the log curve that a maker names in a movie; empty if none does.

    Parameters
    ----------
    path : Path
        The movie.
    metadata : mapping of str to str
        Of the file and of its stream, as FFmpeg reads it.
    """
    if any(key.lower() == ARRI_KEY and value.upper().startswith(ARRI_LOG) for key, value in metadata.items()):
        return ARRI_CURVE
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        texts = [content[part] for part in _beside_pictures(content)]
    texts += [side.read_bytes()[:_LARGEST] for end in SIDECARS if (side := path.with_name(path.stem + end)).is_file()]
    return next((curve for mark, curve in TEXTS.items() if any(re.search(mark, text) for text in texts)), "")


def _beside_pictures(content: mmap.mmap) -> Iterator[slice]:
    """Yield the parts of a file that hold no pictures: the boxes of QuickTime and MP4, or its two ends."""
    if content[4:8] not in QUICKTIME_BOXES:
        yield from (slice(0, _ENDS), slice(max(0, len(content) - _ENDS), len(content)))
        return
    start = 0
    while start + 8 <= len(content):
        size = int.from_bytes(content[start : start + 4])
        if size == 1:
            size = int.from_bytes(content[start + 8 : start + 16])
        end = start + size if size >= 8 else len(content)
        if content[start + 4 : start + 8] != b"mdat":
            yield slice(start, min(end, start + _LARGEST, len(content)))
        start = end
