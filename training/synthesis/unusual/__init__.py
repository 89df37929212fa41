"""Pictures that no family of camera responses explains, made of linear light: what an estimate must refuse.

encodings        log, near-linear and limited range, messengers; the ordinary picture that the others change
tone_mapping     local and global operators on high-dynamic-range light
view_transforms  Blender's Filmic and AgX
film_scan        negatives with grain and dust
filters          artistic filters, solarization, palettes, false color
graphics         screenshots and drawings
kinds            the list of kinds, each with its reason; windows and whole frames of a kind
"""

from training.synthesis.unusual.kinds import RENDERINGS, UnusualKind, random_exposure, unusual_photo, unusual_windows

__all__ = ["RENDERINGS", "UnusualKind", "random_exposure", "unusual_photo", "unusual_windows"]
