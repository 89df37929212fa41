"""What model.json and the model card say of a report."""

from __future__ import annotations

from training.evaluation.baselines import GAMMA, MEAN_CURVE, OTHER_BODIES
from training.evaluation.report.content import Report
from training.evaluation.report.errors import EstimatorSummary
from training.evaluation.report.markdown_tables import rows_of

#: The baselines that stand beside the model.
BASELINES_BESIDE = (GAMMA, MEAN_CURVE, OTHER_BODIES)


def accuracy(report: Report, model: str) -> dict[str, dict[str, float]]:
    """Return the figures of one model for model.json: protocol -> name of a figure -> value.

    The protocols are P0, P2 and, for each set of real photographs, "P4 real", "P4 real_bodies" and "P4 both", as far as
    they were measured, and P6. P4 counts only the photographs whose response is trusted. The figures have no intervals;
    those of a baseline end in its name, and are means.
    """
    figures = {}
    for name, clean in (("P0", report.p0), ("P2", report.p2)):
        if clean:
            counts = {"photographs": clean.overall.photographs}
            figures[name] = counts | _figures(clean.overall.estimators, model)
    for name, real in (report.p4 or {}).items():
        counts = {"photographs": real.trusted.photographs, "bodies": real.trusted.bodies}
        figures[f"P4 {name}"] = counts | _figures(real.trusted.estimators, model)
    for error, protocols in (report.p5 or {}).items():
        for name, models in protocols.items():
            figures[name] |= {
                f"expected {error} mean": models[model].mean_uncertainty,
                f"expected {error} rank correlation": models[model].rank_correlation,
                "band coverage": models[model].band_coverage,
            }
    if report.p6:
        overall, stripped = report.p6[model].overall, report.p6[model].stripped
        figures["P6"] = {
            "photographs": overall.photographs,
            "accepted": overall.fraction,
            "accepted without metadata": stripped.fraction,
        }
    return figures


def _figures(estimators: dict[str, EstimatorSummary], model: str) -> dict[str, float]:
    """Return the figures of one model, and the mean errors of the baselines beside it."""
    figures = estimators[model].named()
    for baseline in BASELINES_BESIDE:
        if baseline in estimators:
            errors = estimators[baseline].errors
            figures |= {f"{error} {baseline}": summary.mean.value for error, summary in errors.items()}
    return dict(sorted(figures.items()))


def accuracy_table(figures: dict[str, dict[str, float]]) -> str:
    """Return the Markdown table of what `accuracy` returned: a row for each figure, a column for each protocol."""
    names = dict.fromkeys(name for column in figures.values() for name in column)
    rows = [[name, *(f"{column[name]:g}" if name in column else "" for column in figures.values())] for name in names]
    return rows_of(["", *figures], rows)


def bodies_table(report: Report, model: str) -> str:
    """Return the Markdown table of the bodies of P4: of both folders, or of the only one; empty without P4."""
    if not report.p4:
        return ""
    rows = []
    for row in list(report.p4.values())[-1].bodies:
        own, *others = (row.estimators[name].errors for name in (model, GAMMA, OTHER_BODIES))
        cells = [f"{errors[error]:.2f}" for error in ("E_est", "shape") for errors in (own, *others)]
        rows.append([row.name, row.grade, str(row.photographs), *cells, f"{row.estimators[model].uncertainty:.2f}"])
    header = [f"{error}{name}" for error in ("E_est", "shape") for name in ("", f", {GAMMA}", f", {OTHER_BODIES}")]
    return rows_of(["body (P4)", "grade", "photographs", *header, "expected E_est"], rows)
