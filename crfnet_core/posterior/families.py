"""Families of responses: the kinds of tone curves of photographs."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Self


class Family(StrEnum):
    """The source of a response.

    The first three are renderings that cameras write themselves, apart because phones leave another headroom and shape
    than compact cameras and cameras with interchangeable lenses. `DEVELOPED` are raw files as programs render them: the
    same shape, but more headroom. `UNEXPLAINED` holds no responses: it stands for pictures that no response of the bank
    explains, such as screenshots or tone-mapped HDR.
    """

    PHONE = "phone"
    COMPACT = "compact"
    CAMERA = "camera"
    DEVELOPED = "developed"
    EDITED = "edited"
    FILM = "film"
    LINEAR = "linear"
    LOG = "log"
    UNEXPLAINED = "unexplained"


IN_CAMERA = (Family.PHONE, Family.COMPACT, Family.CAMERA)  # the renderings of cameras themselves

#: Families in which the answer is not to be trusted as a display-referred camera response. All others are "ordinary". A
#: network states how likely these make a photograph, against an ordinary response, in this order.
UNUSUAL = (Family.LINEAR, Family.LOG, Family.UNEXPLAINED)

#: Groups of families in words for people, in the order in which they are asked.
FAMILY_WORDS: Mapping[tuple[Family, ...], str] = {
    IN_CAMERA: "a camera's own rendering",
    (Family.DEVELOPED,): "developed from a raw file by a program",
    (Family.EDITED, Family.FILM): "edited or unusual",
    (Family.LINEAR,): "nearly linear: do not trust",
    (Family.LOG,): "log-like: do not trust",
    (Family.UNEXPLAINED,): "no photograph that a response explains: do not trust",
}


def is_unusual(families: Mapping[Family, float]) -> bool:
    """Return whether the unusual families are together more probable than all others, so that no answer is trusted."""
    return sum(families.get(family, 0.0) for family in UNUSUAL) > 0.5


@dataclass(frozen=True)
class LikelyKind:
    """The most probable kind of response: of the unusual ones if `is_unusual`, else of the others."""

    families: tuple[Family, ...]  # the families that make up the kind
    words: str  # the kind in words
    probability: float  # that the response is of this kind

    @classmethod
    def from_probabilities(cls, families: Mapping[Family, float]) -> Self | None:
        """Return the most probable kind by the probabilities of families, the first of equals; None without any."""
        if not families:
            return None
        kinds = [
            cls(members, words, sum(families.get(family, 0.0) for family in members))
            for members, words in FAMILY_WORDS.items()
            if (members[0] in UNUSUAL) is is_unusual(families)
        ]
        return max(kinds, key=lambda kind: kind.probability)

    def __str__(self) -> str:
        """Return the words with the probability in percent; never 100, because nothing is certain."""
        percent = "over 99" if self.probability > 0.99 else f"{100 * self.probability:.0f}"
        return f"{self.words}, {percent} %"
