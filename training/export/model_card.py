"""Put measured figures into a model folder: ``python -m training.export.model_card --model DIR --report FILE``.

The report is the report.json of `training.evaluation`. Its overall figures go into model.json, and README.md becomes
the model card.
"""

import argparse
from dataclasses import asdict, replace
from pathlib import Path

from crfnet_core.errors import CRFNetError
from crfnet_core.files import atomic_write_text
from crfnet_core.network import ModelConfig
from crfnet_core.statistics import LENGTH
from training.data.splits import SPLITS
from training.evaluation.baselines import GAMMA, MEAN_CURVE, OTHER_BODIES
from training.evaluation.measure.figures import ERRORS
from training.evaluation.report import paper
from training.evaluation.report.document import Report, read_report, value
from training.evaluation.report.markdown import markdown_table

#: The introductions of the cards, one for each input of networks, their sentences on curves, and the figures; names in
#: braces are filled in.
TEMPLATES = Path(__file__).with_name("model_card_templates")

#: The baselines in model.json, and in the table of bodies.
CARD_BASELINES, BODY_BASELINES = (GAMMA, MEAN_CURVE, OTHER_BODIES), (GAMMA, OTHER_BODIES)

#: The protocols in model.json.
CARD_PROTOCOLS = ("P0", "P2", "P4 real", "P4 real_bodies", "P4 both")

#: The figures of a model in model.json.
CARD_FIGURES = tuple(f"{error} {name}" for error in ERRORS for name in ("mean", "median", "p90", "ratio", "win rate"))


def introduction(folder: Path, config: ModelConfig) -> str:
    """Return the text before the figures."""
    held_out = len(config.training.get("held_out_curves", ()))
    template = (TEMPLATES / f"{config.input_name}.md").read_text()
    curves = (TEMPLATES / ("held_out_curves.md" if held_out else "all_curves.md")).read_text().rstrip()
    return template.format(
        **asdict(config),
        size=(folder / "model.onnx").stat().st_size / 1e6,
        statistics=LENGTH,
        scenes=len(SPLITS["scenes"]["validation"]),
        curves=curves.format(count=held_out),
    )


def card_text(folder: Path, config: ModelConfig, report: Report) -> str:
    """Return the text of the model card."""
    figures = (TEMPLATES / "accuracy.md").read_text()
    on_p2 = " P2: the same of responses held out of training." if report.table("P2") else ""
    tables = {"accuracy": accuracy_table(config.accuracy), "bodies": bodies_table(report, config.name)}
    return f"{introduction(folder, config)}\n{figures.format(on_p2=on_p2, paper=paper, **tables)}"


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


def checked_report(path: Path, config: ModelConfig) -> Report:
    """Return the report; CRFNetError if it is of another model, was measured on the bundled scenes, or lacks P0."""
    report = read_report(path)
    if report.models.get(config.name) != config.sha256:
        raise CRFNetError(f"{path}: holds no figures of {config.label}; evaluate this model")
    if not report.table("P0") or report.notes:
        raise CRFNetError(f"{path}: not a whole evaluation on the data; evaluate with --data, anew if code changed")
    return report


def main() -> None:
    """Write the figures into model.json and README.md."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--model", type=Path, required=True, help="the model's folder")
    parser.add_argument("--report", type=Path, required=True, help="report.json of training.evaluation")
    options = parser.parse_args()
    config = ModelConfig.read(options.model / "model.json")
    try:
        report = checked_report(options.report, config)
    except CRFNetError as problem:
        raise SystemExit(str(problem)) from None
    config = replace(config, accuracy=accuracy(report, config.name))
    config.write(options.model / "model.json")
    text = card_text(options.model, config, report)
    atomic_write_text(options.model / "README.md", text, overwrite=True)
    print(text)


if __name__ == "__main__":
    main()
