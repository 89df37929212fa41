"""The rows of the report: sums over groups of photographs, protocol by protocol."""

from collections.abc import Iterator, Sequence

from training.evaluation.baselines import GAMMA, OTHER_BODIES
from training.evaluation.measure.real import POOLED
from training.evaluation.measure.simulated import PAPER
from training.evaluation.plan import RESOLUTIONS
from training.evaluation.report import paper, summary
from training.evaluation.report.cases import Cases
from training.evaluation.report.document import ReportRow

#: Group of bodies, by how many photographs of each were estimated together -> the least number of photographs.
POOLED_GROUPS = {"4 photographs": 4, "2 to 4 photographs": 2}


def clean_rows(protocol: str, cases: Cases, models: Sequence[str]) -> Iterator[ReportRow]:
    """Yield the figures of P0 or P2: of all photographs, by exposure, by kind of scene; and P5."""
    yield from _errors(protocol, "", cases, list(cases.rows), compared=models)
    for column in ("exposure", "kind"):
        for name, index in cases.groups(column).items():
            yield from _errors(f"{protocol} by {column}", str(name), cases.part(index), [*models, GAMMA])
    yield from reliability_rows(protocol, cases, models)


def stress_rows(conditions: dict[str, Cases]) -> Iterator[ReportRow]:
    """Yield the figures of the protocol "paper" under every condition, the first of which is clean, and the paper's."""
    clean = next(iter(conditions.values()))
    for group, cases in conditions.items():
        base = conditions.get(RESOLUTIONS[0].name, cases) if group.startswith("resolution") else clean
        for name in cases.rows:
            figures = summary.errors(cases, name) | summary.partial_errors(cases, name)
            if name in base.rows:
                figures |= summary.changes(cases, base, name)
            yield _row(PAPER, group, name, cases, figures)
        if group in paper.STRESS:
            error = paper.STRESS[group].estimation
            figures = {"E_est mean": error, "E_est x clean": error / paper.OVERALL.estimation}
            figures |= {"E_lin mean": paper.STRESS[group].linearization}
            yield _row(PAPER, group, paper.PAPER, cases, figures)


def real_rows(protocol: str, cases: Cases, ways: Sequence[str]) -> Iterator[ReportRow]:
    """Yield the figures of the real photographs that count and of all, by kind of body; and P5."""
    counted = without_caution(cases)
    for table, part in ((protocol, counted), (f"{protocol}, with caution", cases)):
        for row in _errors(table, "", part, list(part.rows), compared=[*ways, OTHER_BODIES]):
            way = row["estimator"]
            yield row | (summary.verdicts(part, way) | summary.weight_correlations(part, way) if way in ways else {})
    for kind, index in counted.groups("kind").items():
        yield from _errors(f"{protocol} by kind", kind, counted.part(index), list(counted.rows))
    yield from reliability_rows(protocol, counted, ways)


def body_rows(protocol: str, cases: Cases, ways: Sequence[str]) -> Iterator[ReportRow]:
    """Yield the mean figures of every body, of the photographs that count."""
    counted = without_caution(cases)
    for index in sorted(counted.groups("body key").values()):
        part = counted.part(index)
        first, grade = part.first[0], "".join(sorted({row["grade"] for row in part.first}))
        for name in [*ways, GAMMA, OTHER_BODIES]:
            figures = {"kind": first["kind"], "grade": grade} | summary.means(part, name)
            yield _row(f"{protocol} by body", first["body"], name, part, figures)


def pooled_rows(table: str, cases: Cases, models: Sequence[str]) -> Iterator[ReportRow]:
    """Yield the figures of the bodies of which at least so many photographs were estimated together."""
    bodies = cases.groups("body key").values()
    names = [name for model in models for name in (model + POOLED, model)]
    for group, least in POOLED_GROUPS.items():
        part = cases.part(sorted(number for body in bodies if len(body) >= least for number in body))
        if len(part):
            yield from _errors(table, group, part, [*names, OTHER_BODIES])


def reliability_rows(protocol: str, cases: Cases, estimators: Sequence[str]) -> Iterator[ReportRow]:
    """Yield how well the uncertainties of models foretell their errors (P5)."""
    for error in ("E_est", "shape"):
        for name in estimators:
            yield _row(f"P5 {error}", protocol, name, cases, summary.reliability(cases, error, name))


def unusual_rows(cases: Cases) -> Iterator[ReportRow]:
    """Yield how many of the pictures of P6 are accepted, of all and of every kind."""
    groups = {"": list(range(len(cases)))} | cases.groups("kind")
    for kind, index in groups.items():
        part = cases.part(index)
        for way in part.rows:
            accepted = summary.verdicts(part, way)["accepted"]
            figures = {"accepted": accepted, "accepted fraction": accepted / len(part)}
            yield _row("P6 by kind" if kind else "P6", kind, way, part, figures)


def without_caution(cases: Cases) -> Cases:
    """Return the photographs that count in the means."""
    return cases.part(cases.groups("caution").get("", []))


def _errors(
    table: str, group: str, cases: Cases, estimators: Sequence[str], *, compared: Sequence[str] = ()
) -> Iterator[ReportRow]:
    """Yield the errors of estimators, and of the first of `compared` less each other of them; and how many bodies."""
    bodies = {"bodies": len(cases.groups("body key"))} if cases.is_real else {}
    for name in estimators:
        figures = summary.errors(cases, name)
        if name in compared[1:]:
            figures |= summary.differences(cases, compared[0], name)
        yield _row(table, group, name, cases, figures | bodies)


def _row(table: str, group: str, estimator: str, cases: Cases, figures: summary.Figures) -> ReportRow:
    return {"table": table, "group": group, "estimator": estimator, "photographs": len(cases)} | figures
