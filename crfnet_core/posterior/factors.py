"""Factors by which metadata shifts the prior: the probability of the metadata under each family of responses.

The factors of several findings are multiplied as if they were independent, so each is mild where another repeats it.
They are set by hand, for the reasons given; only the probability that a camera's file has lost its EXIF, "no camera",
was chosen on real photographs (docs/ACCURACY.md).
"""

from collections.abc import Sequence

import numpy as np

from crfnet_core.photograph.metadata import Device, Encoding, FileOrigin
from crfnet_core.posterior.families import Family

#: Least product of factors. Metadata can be wrong (copied, stripped, an unknown model): pixels that are sure win.
LEAST_FACTOR = 0.005

#: Finding -> P(finding | family) in the order of `Family`, up to a common factor; 1 is neutral.
FACTORS: dict[str, tuple[float, ...]] = {
    # EXIF of a device is kept by editors and lost by scans and frames; apps write linear and log pictures, rarely.
    Device.PHONE: (1, 0.03, 0.03, 0.1, 0.3, 0.02, 0.02, 0.05, 0.2),
    # A maker gives its compacts and its cameras much the same rendering; compacts have no log pictures.
    Device.COMPACT: (0.03, 1, 0.15, 0.1, 0.3, 0.02, 0.02, 0.02, 0.2),
    # Cameras and compacts of a maker have much the same rendering; those who develop raw files, to linear pictures too,
    # or grab log frames, use such cameras.
    Device.CAMERA: (0.03, 0.1, 1, 1, 0.3, 0.02, 0.03, 0.05, 0.2),
    # Behind a scan lies film or a print, and the program of the scanner changes tones like an editor.
    Device.SCANNER: (0.01, 0.01, 0.01, 0.01, 0.5, 1, 0.05, 0.02, 0.3),
    # The colors of thermal cameras stand for temperatures.
    Device.THERMAL: (0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 1),
    # The user states the device, whatever became of the picture: log footage, raw files and graded pictures are taken
    # with cameras, too, screenshots and renderings are not. A scan is the same, whoever states the scanner.
    "stated phone": (1, 0.03, 0.03, 0.3, 1, 0.05, 1, 1, 0.5),
    "stated compact": (0.03, 1, 0.15, 0.3, 1, 0.05, 1, 1, 0.5),
    "stated camera": (0.03, 0.1, 1, 1, 1, 0.05, 1, 1, 0.5),
    "stated other": (1, 1, 1, 1, 1, 0.3, 1, 1, 0.5),
    "stated scanner": (0.01, 0.01, 0.01, 0.01, 0.5, 1, 0.05, 0.02, 0.3),
    "stated thermal camera": (0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 1),
    # Cameras write EXIF, which editors and scanners mostly keep or write, and messengers strip. Frames, linear and log
    # data, renderings and screenshots never had it.
    "no camera": (0.2, 0.2, 0.2, 0.2, 0.3, 0.5, 1, 1, 1),
    # Who saves from an editor mostly changed tones, though some only scale or turn; developers also write the rest.
    "editor": (1, 1, 1, 3, 5, 2, 2, 1, 2),
    # The same program may have edited the picture that it developed. Few use such programs for the camera's own files.
    "developed": (0.01, 0.01, 0.01, 1, 0.05, 0.01, 0.1, 0.05, 0.2),
    # Nothing but the camera has written the file; its picture may still be flat on purpose, or an app's.
    "as the camera wrote it": (1, 1, 1, 0.02, 0.05, 0.1, 0.1, 0.3, 0.4),
    # Who scales for the web often edits before; linear and log pictures are for work and keep their size.
    "scaled": (1, 1, 1, 1.5, 1.5, 1, 0.5, 0.5, 1.2),
    # The program that encoded it again is a messenger, a site or an editor.
    "encoded again": (1, 1, 1, 1.5, 1.5, 1, 0.7, 0.7, 1.2),
    # The shapes count only where no device is named. Reflex and mirrorless cameras and 35 mm film have 3:2.
    "3:2": (0.15, 0.15, 1, 1, 0.8, 1, 0.7, 0.3, 0.6),
    # Phones, compacts and Micro Four Thirds take 4:3, and old video does.
    "4:3": (1, 1, 0.35, 0.4, 0.7, 0.6, 0.7, 0.4, 0.7),
    # Phones and video take 16:9; cameras and compacts only if asked to.
    "16:9": (1, 0.4, 0.3, 0.3, 0.7, 0.7, 0.8, 2, 1),
    # Phones as long as their screens, and cinema.
    "2:1": (1, 0.1, 0.1, 0.3, 0.5, 0.5, 0.5, 1, 0.8),
    # DPX holds scanned film, log and video frames; no still camera writes it.
    Encoding.FOOTAGE: (0.05, 0.05, 0.1, 0.2, 0.5, 1, 0.5, 1, 0.5),
    # Every camera takes movies, and programs make them.
    Encoding.MOVIE: (1, 1, 1, 1, 1, 1, 1, 1, 1),
}


def metadata_factors(origins: Sequence[FileOrigin]) -> dict[Family, float]:
    """Return the factors of the prior for photographs of one camera, by their geometric mean; {} without any."""
    if not origins:
        return {}
    factors = [family_factors(origin) for origin in origins]
    return {family: float(np.exp(np.mean([np.log(each[family]) for each in factors]))) for family in Family}


def family_factors(origin: FileOrigin) -> dict[Family, float]:
    """Return family -> P(metadata | family), relative: the largest is 1, and none is below `LEAST_FACTOR`."""
    factors = dict.fromkeys(Family, 1.0)
    for finding in findings(origin):
        for family, factor in zip(Family, FACTORS[finding], strict=True):
            factors[family] *= factor
    largest = max(factors.values())
    return {family: max(factor / largest, LEAST_FACTOR) for family, factor in factors.items()}


def findings(origin: FileOrigin) -> list[str]:
    """Return the rows of `FACTORS` that hold of a file."""
    is_still = origin.encoding != Encoding.MOVIE  # most movies are 16:9, and few name their camera
    rows = {
        f"stated {origin.device or 'other'}": origin.has_stated_device,
        origin.device: not origin.has_stated_device and origin.device != Device.UNKNOWN,
        "no camera": is_still and not origin.camera and not origin.has_stated_device,
        origin.picture_shape: is_still and origin.device == Device.UNKNOWN and origin.picture_shape in FACTORS,
        "developed": origin.is_developed,
        "editor": bool(origin.editor) and not origin.is_developed,
        "scaled": origin.is_scaled is True,
        "encoded again": origin.is_resaved is True and not origin.editor and not origin.is_scaled,
        "as the camera wrote it": origin.is_resaved is False,
        origin.encoding: origin.encoding != Encoding.UNKNOWN,
    }
    return [str(finding) for finding, holds in rows.items() if holds]
