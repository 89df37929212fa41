"""Figures of a report for model.json and the model card."""

from __future__ import annotations

from training.evaluation.baselines import GAMMA, MEAN_CURVE, OTHER_BODIES
from training.evaluation.measure.figures import ERRORS
from training.evaluation.report.document import Report, value
from training.evaluation.report.markdown import markdown_table

#: The baselines in model.json, and in the table of bodies.
CARD_BASELINES, BODY_BASELINES = (GAMMA, MEAN_CURVE, OTHER_BODIES), (GAMMA, OTHER_BODIES)

#: The protocols in model.json.
CARD_PROTOCOLS = ("P0", "P2", "P4 real", "P4 real_bodies", "P4 both")

#: The figures of a model in model.json.
CARD_FIGURES = tuple(f"{error} {name}" for error in ERRORS for name in ("mean", "median", "p90", "ratio", "win rate"))


def accuracy(report: Report, model: str) -> dict[str, dict[str, float]]:
    """Return the figures of one model for model.json: protocol -> name of a figure -> value, without intervals.

    P4 counts the photographs without caution. Figures of a baseline end in its name, and are means.
    """
    figures: dict[str, dict[str, float]] = {}
    for protocol in CARD_PROTOCOLS:
        if row := report.row(protocol, model):
            counts = {name: row[name] for name in ("photographs", "bodies") if name in row}
            own = {name: value(row[name]) for name in (*CARD_FIGURES, "PSNR of the mean")}
            for name in CARD_BASELINES:
                if other := report.row(protocol, name):
                    own |= {f"{error} {name}": value(other[f"{error} mean"]) for error in ERRORS}
            figures[protocol] = counts | dict(sorted(own.items())) | _stated(report, protocol, model)
    if row := report.row("P6", model):
        stripped = report.row("P6", f"{model}, without metadata")
        figures["P6"] = {
            "photographs": row["photographs"],
            "accepted": row["accepted fraction"],
            "accepted without metadata": stripped["accepted fraction"],
        }
    return figures


def _stated(report: Report, protocol: str, model: str) -> dict[str, float]:
    """Return the figures of P5 of one model on one protocol."""
    figures: dict[str, float] = {}
    for error in ("E_est", "shape"):
        row = report.row(f"P5 {error}", model, protocol)
        figures |= {
            f"expected {error} mean": row["stated mean"],
            f"expected {error} rank correlation": row["rank correlation"],
            "band coverage": row["band coverage"],
        }
    return figures


def accuracy_table(figures: dict[str, dict[str, float]]) -> str:
    """Return the Markdown table of what `accuracy` returned: a row for each figure, a column for each protocol."""
    names = dict.fromkeys(name for column in figures.values() for name in column)
    rows = [[name, *(f"{column[name]:g}" if name in column else "" for column in figures.values())] for name in names]
    return markdown_table(["", *figures], rows)


def bodies_table(report: Report, model: str) -> str:
    """Return the Markdown table of the bodies of P4; empty without P4."""
    lines = []
    for row in report.rows:
        if row["table"].endswith(" by body") and row["estimator"] == model:
            others = [report.row(row["table"], name, row["group"]) for name in BODY_BASELINES]
            cells = [f"{each[f'{error} mean']:.2f}" for error in ("E_est", "shape") for each in (row, *others)]
            expected = f"{row['expected E_est mean']:.2f}"
            lines.append([row["group"], row["grade"], str(row["photographs"]), *cells, expected])
    names = ["", *(f", {name}" for name in BODY_BASELINES)]
    errors = [error + name for error in ("E_est", "shape") for name in names]
    header = ["body (P4)", "grade", "photographs", *errors, "expected E_est"]
    return markdown_table(header, lines) if lines else ""
