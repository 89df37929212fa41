"""The part of the report on P6, pictures that no response explains: what it holds and its section of report.md."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from training.evaluation.report.markdown_tables import rows_of
from training.evaluation.report.real.content import RealReport, ways_of

INTRODUCTION = """\
Every kind of picture of every test scene, as a file that names no camera, with the prior "camera". Blender's renders
and messengers' copies have the metadata that these programs write; the last row but one is without, and so is the last
row, asked by a user who says, rightly or wrongly, that a camera took them. "Accepted" are those that the model calls
"good" or "usable": the fewer the better.
"""

REFUSED_TEXT = """\
Photographs of P4 with the verdict "do not trust": a model that refuses everything accepts none of the pictures above.
"""


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
    def fraction(self) -> float:
        """The part that is accepted, in [0, 1]; 0 if there are no pictures."""
        return self.accepted / self.photographs if self.photographs else 0.0


@dataclass(frozen=True)
class UnusualReport:
    """P6 of one model.

    Parameters
    ----------
    kinds : dict
        Kind of picture -> how many are accepted.
    overall : Accepted
        Of all kinds together.
    stripped : Accepted
        The same without any metadata.
    told : Accepted
        Without any metadata, asked by a user who says that a camera took them.
    """

    kinds: dict[str, Accepted]
    overall: Accepted
    stripped: Accepted
    told: Accepted


def unusual_section(reports: dict[str, UnusualReport], real: dict[str, RealReport] | None) -> list[str]:
    """Return the section of P6, beside the photographs of P4 that are refused, if these were measured."""
    models = list(reports)
    kinds = list(next(iter(reports.values())).kinds)
    rows = [[kind, *(_cell(reports[name].kinds[kind]) for name in models)] for kind in kinds]
    rows.append(["**all kinds**", *(_cell(reports[name].overall) for name in models)])
    rows.append(["all kinds, without metadata", *(_cell(reports[name].stripped) for name in models)])
    rows.append(["all kinds, without metadata, a camera told", *(_cell(reports[name].told) for name in models)])
    parts = ["## P6: pictures that no response explains\n", INTRODUCTION]
    parts.append(rows_of(["kind", *(f"{name}: accepted" for name in models)], rows))
    if real:
        parts += ["Photographs of cameras that are refused:\n", REFUSED_TEXT, _refused(list(real.values())[-1], models)]
    return parts


def _refused(report: RealReport, models: Sequence[str]) -> str:
    """Return the table of refused photographs of P4, asked in all ways."""
    everything = report.everything or report.trusted
    rows = []
    for name in [way for model in models for way in ways_of(model)]:
        groups = (
            (report.trusted.photographs, report.trusted_wrongly[name].photographs),
            (everything.photographs, report.trusted_wrongly_of_everything[name].photographs),
        )
        rows.append([name, *(_cell(Accepted(total, total - trusted)) for total, trusted in groups)])
    return rows_of(["", "refused, of those that count", "refused, of all"], rows)


def _cell(counts: Accepted) -> str:
    """Return a fraction in percent, and the counts."""
    return f"{100 * counts.fraction:.0f} % ({counts.accepted} of {counts.photographs})"
