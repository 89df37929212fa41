"""Families of responses: what kinds of tone curves photographs have gone through."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum


class Family(StrEnum):
    """Where a response comes from.

    The first three are renderings that cameras write themselves, apart because phones leave another headroom and shape
    than compact cameras and cameras with interchangeable lenses. `UNEXPLAINED` holds no responses: it stands for
    pictures that no response of the bank explains, such as screenshots or tone-mapped HDR.
    """

    PHONE = "phone"
    COMPACT = "compact"
    CAMERA = "camera"
    EDITED = "edited"
    FILM = "film"
    LINEAR = "linear"
    LOG = "log"
    UNEXPLAINED = "unexplained"


#: What a camera renders itself.
IN_CAMERA = (Family.PHONE, Family.COMPACT, Family.CAMERA)

#: Families in which the answer is not to be trusted as a display-referred camera response.
UNUSUAL = (Family.LINEAR, Family.LOG, Family.UNEXPLAINED)

#: The families whose log-odds a network states, against all others together: the order of its outputs.
STATED_ODDS = (Family.LINEAR, Family.LOG, Family.UNEXPLAINED)

#: Groups of families in words for people, in the order in which they are asked.
FAMILY_WORDS: Mapping[tuple[Family, ...], str] = {
    IN_CAMERA: "a camera's own rendering",
    (Family.EDITED, Family.FILM): "edited or unusual",
    (Family.LINEAR,): "nearly linear: do not trust",
    (Family.LOG,): "log-like: do not trust",
    (Family.UNEXPLAINED,): "no photograph that a response explains: do not trust",
}
