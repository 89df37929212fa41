"""Put measured figures into a model folder: ``python -m training.export.model_card --model DIR --report FILE``.

The report is the report.json of `training.evaluation`. Its overall figures go into model.json, and README.md becomes
the model card.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from crfnet_core.errors import CRFNetError
from crfnet_core.files import atomic_write_text
from crfnet_core.network import ModelConfig
from crfnet_core.statistics import LENGTH
from training.data.scenes import VALIDATION_SCENES
from training.evaluation import paper
from training.evaluation.baselines import GAMMA
from training.evaluation.markdown_tables import rows_of

Table = dict[str, Any]

#: The introductions of the cards, one for each input of networks; the names in braces are filled in.
TEMPLATES = Path(__file__).with_name("model_card_templates")

ALL_CURVES = (
    "All 201 DoRF curves are in training. So P0 below tells the accuracy on new photographs of known responses, and the"
    " real\nphotographs tell the accuracy on new cameras."
)

HELD_OUT_CURVES = (
    "{count} of the 201 DoRF curves, and all mixtures with them, are left out: P2 below is measured on these."
)


def introduction(folder: Path, config: ModelConfig) -> str:
    """Return what the card says before its figures."""
    held_out = len(config.training.get("held_out_curves", ()))
    return (
        (TEMPLATES / f"{config.input_name}.md")
        .read_text()
        .format(
            **asdict(config),
            **asdict(config.uncertainty_model),
            size=(folder / "model.onnx").stat().st_size / 1e6,
            statistics=LENGTH,
            scenes=VALIDATION_SCENES,
            curves=HELD_OUT_CURVES.format(count=held_out) if held_out else ALL_CURVES,
        )
    )


def overall_figures(protocol: Table, model: str, *, photographs: int) -> dict[str, float]:
    """Return the figures of one model and of gamma 2.2 in a protocol, without intervals, for model.json."""
    own, gamma = protocol["estimators"][model], protocol["estimators"][GAMMA]
    figures: dict[str, float] = {name: figure["value"] for name, figure in own.items()}
    figures |= {f"{error} {GAMMA}": gamma[f"{error} mean"]["value"] for error in ("E_est", "E_lin")}
    return {"photographs": photographs, **dict(sorted(figures.items()))}


def accuracy(report: Table, model: str) -> dict[str, dict[str, float]]:
    """Return the figures of those of P0, P2 and P4 (cameras of grade A and B) that were measured, for model.json."""
    figures: dict[str, dict[str, float]] = {}
    for name in ("P0", "P2", "P4"):
        if name not in report:
            continue
        part = report[name]["trusted"] if name == "P4" else report[name]
        trust = report["P5"][name][model]
        figures[name] = overall_figures(part, model, photographs=part["photographs"]) | {
            "uncertainty mean": trust["mean uncertainty"],
            "uncertainty rank correlation": trust["rank correlation"],
            "band coverage": trust["band coverage"],
        }
    return figures


def card_text(folder: Path, config: ModelConfig, report: Table) -> str:
    """Return the text of the model card."""
    protocols = config.accuracy
    rows = [
        [name, *(f"{figures[name]:g}" for figures in protocols.values())] for name in next(iter(protocols.values()))
    ]
    parts = [
        introduction(folder, config),
        "## Accuracy\n",
        "P0: known responses, each at one of five exposures (s_crf x 0.6 to 1.4), on held-out scenes, 8 bits. P2: the"
        " same of responses held out of training. P4: real photographs with measured responses (grades A and B), means"
        " over cameras; nothing was chosen on them. E_lin is x 1e-2. To compare: the mean of the 201 curves has an"
        f" E_est of 2.91 on P0, the paper's network (on other photographs) {paper.OVERALL.estimation:.2f}.\n",
        rows_of(["", *protocols], rows),
        *_cameras(report, config.name),
        "How it is made and measured: `training/README.md`.",
    ]
    return "\n".join(parts) + "\n"


def _cameras(report: Table, model: str) -> list[str]:
    """Return the table of the real cameras, or nothing if they were not measured."""
    if "P4" not in report:
        return []
    rows = []
    for camera, row in report["P4"]["cameras"].items():
        own, gamma = row["estimators"][model], row["estimators"][GAMMA]
        figures = (own["E_est"], gamma["E_est"], own["uncertainty"])
        rows.append([camera, row["grades"], str(row["photographs"]), *(f"{figure:.2f}" for figure in figures)])
    return [rows_of(["camera (P4)", "grade", "photographs", "E_est", GAMMA, "uncertainty"], rows)]


def checked_report(path: Path, config: ModelConfig) -> Table:
    """Return the report, which must hold figures of this very model.

    Raises
    ------
    CRFNetError
        If it is of another model, was measured on the bundled scenes, or lacks P0.
    """
    report: Table = json.loads(path.read_text())
    found = report["models"].get(config.name, {}).get("sha256")
    if found != config.sha256:
        raise CRFNetError(f"{path}: holds no figures of {config.label}; evaluate this model")
    if "P0" not in report or report["notes"]:
        raise CRFNetError(f"{path}: is no whole evaluation on the data; evaluate with --data, anew if code changed")
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
