"""Pictures that must be refused: every kind of every test scene, and how often a model accepts them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from crfnet_core.photo import Photo
from crfnet_core.posterior import Verdict
from training.evaluation.test_sets import SceneFile
from training.synthesis.unusual import UnusualKind, unusual_photo

#: Seed of the pictures. Each has a generator of its own, so a kind that is added last changes no other picture.
SEED = 2017


@dataclass(frozen=True)
class Accepted:
    """How many pictures a model calls "good" or "usable", of how many.

    Parameters
    ----------
    photographs : int
        All pictures.
    accepted : int
        Those with the verdict "good" or "usable".
    """

    photographs: int
    accepted: int

    @property
    def share(self) -> float:
        """The part that is accepted, in [0, 1]; 0 if there are no pictures."""
        return self.accepted / self.photographs if self.photographs else 0.0


def unusual_photographs(
    scenes: Iterable[SceneFile], kinds: Sequence[UnusualKind] = tuple(UnusualKind), *, seed: int = SEED
) -> Iterator[tuple[UnusualKind, Photo]]:
    """Yield every kind of every scene, each rendered when it is asked for; the same arguments give the same pictures.

    Parameters
    ----------
    scenes : iterable of SceneFile
        The scenes of a test set; each is read once.
    kinds : sequence of UnusualKind
        The kinds.
    seed : int
        Of everything that is random.
    """
    numbers = {kind: number for number, kind in enumerate(UnusualKind)}
    for number, file in enumerate(scenes):
        scene = file.read()
        for kind in kinds:
            yield kind, unusual_photo(kind, scene, np.random.default_rng([seed, numbers[kind], number]))


def accepted_by_kind(verdicts: Iterable[tuple[UnusualKind, Verdict]]) -> dict[UnusualKind, Accepted]:
    """Return kind -> how many of its pictures are called "good" or "usable", in the order of the kinds.

    Parameters
    ----------
    verdicts : iterable of (UnusualKind, Verdict)
        One for each picture; a kind without any is left out.
    """
    listed = list(verdicts)
    photographs = Counter(kind for kind, _ in listed)
    accepted = Counter(kind for kind, verdict in listed if verdict != Verdict.DO_NOT_TRUST)
    return {kind: Accepted(photographs[kind], accepted[kind]) for kind in UnusualKind if photographs[kind]}


def accepted_overall(by_kind: dict[UnusualKind, Accepted]) -> Accepted:
    """Return the sum over kinds."""
    rows = by_kind.values()
    return Accepted(sum(row.photographs for row in rows), sum(row.accepted for row in rows))
