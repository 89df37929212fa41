r"""Write docs/PAPER.md: each number of the CRF-net paper beside ours.

    python -m training.evaluation --data DATA --out OUT --model photograph-statistics-2.4 crfnet2017 \
        --protocol p0 paper p4 --photographs 402 --stressed 40
    python -m training.evaluation.paper_page --data DATA --out OUT --page docs/PAPER.md

The second command reads OUT/report.json and the table beside it, and draws PAPER-curves.png and PAPER-stress.png beside
the page. The first model is the default, the second the paper's network.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from crfnet_core.estimate.estimate import estimate_response
from crfnet_core.files import atomic_write, atomic_write_text
from crfnet_core.network import ResponseNetwork
from crfnet_core.posterior import Prior
from crfnet_core.response.curve import ResponseCurve
from training.data.curves import IRRADIANCE
from training.evaluation.baselines import GAMMA, OTHER_BODIES
from training.evaluation.measure.simulated import PAPER, PRIOR, WAYS, Job
from training.evaluation.measure.table import TABLE_FILE, Cases, Table, code_digest
from training.evaluation.models import Model
from training.evaluation.plan import TestPhotograph, clean_photographs
from training.evaluation.report import paper
from training.evaluation.report.document import Report, ReportRow, read_report, value
from training.evaluation.report.markdown import markdown_table
from training.evaluation.test_sets import TestSet, dorf_test_set

#: The text of the page around its tables and plots; the names in braces are filled in.
TEMPLATE = Path(__file__).with_name("paper_page.md")

#: Heads of groups of rows -> label of a row -> condition of the protocol `PAPER`.
EXPERIMENTS: dict[str, dict[str, str]] = {
    "Table 2: exposure": {
        "0.6": "exposure 0.6",
        "0.8": "exposure 0.8",
        "1.0": "clean",
        "1.2": "exposure 1.2",
        "1.4": "exposure 1.4",
    },
    "Sec. 5.2: resolution": {f"{times}x": f"resolution {times}x" for times in (1, 2, 4)},
    "Sec. 5.3:": {"without color": "grayscale"},
    "Table 3: noise": {each: f"noise variance {each}" for each in ("0.5", "1", "2", "4")},
    "Table 4: blur": {each: f"blur variance {each}" for each in ("1", "2", "4", "8")},
    "Fig. 7: severe exposure": {each: f"exposure {each}" for each in ("0.15", "4")},
    "Fig. 8: white balance": {each: f"{each} white balance" for each in ("cool", "warm")},
}

#: Groups that are plotted, the place of the clean photographs on their axis, and the word under it.
PLOTTED = {
    "Table 2: exposure": (None, "exposure, times s_crf"),
    "Table 3: noise": (0.0, "variance of the noise"),
    "Table 4: blur": (0.0, "variance of the blur"),
}

#: Quantiles of the network's E_est on P0: of the photographs whose curves are drawn.
EXAMPLES = (0.1, 0.5, 0.9)

#: Size of the plots in inches, their resolution, and the colors of truth and estimators.
SIZE, DPI, COLORS = (9.0, 2.9), 80, ("#7b3294", "#1b9e3c", "#d95f02", "#808080")


@dataclass(frozen=True)
class Page:
    """A report and the estimators that it shows, in their order: the paper, its network, the default, gamma 2.2."""

    report: Report

    @property
    def models(self) -> tuple[str, str]:
        """The paper's network and the default model."""
        default, network = self.report.models
        return network, default

    @property
    def estimators(self) -> tuple[str, ...]:
        """The names in the report."""
        return (paper.PAPER, *self.models, GAMMA)

    def cells(self, table: str, group: str = "", estimators: Sequence[str] = ()) -> list[str]:
        """Return the errors of estimators on a group."""
        return [_errors(self.report.row(table, name, group)) for name in estimators or self.estimators]

    def experiments(self) -> str:
        """Return the table of all conditions."""
        stated = [_stated(paper.OVERALL), *self.cells("P0", estimators=self.estimators[1:3]), _gamma(self.report)]
        rows = [["Sec. 4: all photographs", *stated]]
        for head, conditions in EXPERIMENTS.items():
            rows += [[f"{head} {label}", *self.cells(PAPER, name)] for label, name in conditions.items()]
        return markdown_table(["E_est [95 %] (E_lin)", *self.estimators], rows)

    def wins(self) -> str:
        """Return the table of Sec. 5.6."""
        rates = (paper.WIN_RATE.estimation, paper.WIN_RATE.linearization)
        rows = [["the paper", *(f"{100 * rate:.0f} %" for rate in rates)]]
        for name in self.models:
            row = self.report.row("P0", name)
            rows.append([name, *(_percent(row[f"{error} win rate"]) for error in ("E_est", "E_lin"))])
        return markdown_table(["Sec. 5.6: better than gamma 2.2 on", "by E_est", "by E_lin"], rows)

    def windows(self) -> str:
        """Return the table of Fig. 3 and Fig. 9."""
        heads = [f"Fig. 3: {way.removeprefix(', one ')}" for way in WAYS]
        heads = [*heads, "ten windows", "Fig. 9: below 80 % brightness", "the same, scaled"]
        rows = []
        for name in self.models:
            ways = [_errors(self.report.row(PAPER, name + way, "clean")) for way in (*WAYS, "")]
            row = self.report.row(PAPER, name, "clean")
            rows.append([name, *ways, *(_interval(row[f"{part} mean"]) for part in ("lower", "partial"))])
        return markdown_table(["clean photographs", *heads], rows)

    def real(self) -> str:
        """Return the table of Fig. 6."""
        rows = [["the paper, 8 photographs", "1.06 (0.42 to 2.18)", "", "2.82"]]
        for name in (*self.models, OTHER_BODIES, GAMMA):
            row = self.report.row("P4 both", name)
            figures = (_interval(row["E_est mean"]), _interval(row["shape mean"], 3), f"{value(row['E_lin mean']):.2f}")
            rows.append([name, *figures])
        return markdown_table(["Fig. 6: real photographs", "E_est", "shape error in stops", "E_lin"], rows)

    def facts(self) -> dict[str, Any]:
        """Return the figures that the text names."""
        overall = self.report.row("P0", self.models[0])
        return {
            "network": self.models[0],
            "default": self.models[1],
            "ratio": value(overall["E_est ratio"]),
            "photographs": overall["photographs"],
            "stressed": self.report.row(PAPER, GAMMA, "clean")["photographs"],
            "bodies": self.report.row("P4 both", GAMMA)["bodies"],
        }


def page_text(report: Report) -> str:
    """Return the page."""
    page = Page(report)
    tables = {name: getattr(page, name)() for name in ("experiments", "wins", "windows", "real")}
    return TEMPLATE.read_text().format(**page.facts(), **tables)


def draw_stress(path: Path, report: Report) -> None:
    """Draw E_est against exposure, noise and blur."""
    page, figure = Page(report), _figure()
    for axes, (head, (clean, word)) in zip(figure.subplots(1, 3, sharey=True), PLOTTED.items(), strict=True):
        conditions = ({} if clean is None else {str(clean): "clean"}) | EXPERIMENTS[head]
        for name, color in zip(page.estimators, COLORS, strict=True):
            errors = [report.row(PAPER, name, group).get("E_est mean", np.nan) for group in conditions.values()]
            axes.plot(
                [float(at) for at in conditions], [value(error) for error in errors], "o-", color=color, label=name
            )
        axes.set_xlabel(word)
    figure.axes[0].set_ylim(bottom=0)  # for all, once each has widened the range
    figure.axes[0].set_ylabel("E_est")
    figure.axes[0].legend(fontsize=7)
    _save(figure, path)


def draw_curves(path: Path, report: Report, data: Path, table: Table) -> None:
    """Draw the responses of `EXAMPLES`: true, of both models, and gamma 2.2."""
    page, test_set, figure = Page(report), dorf_test_set(data), _figure()
    models = [Model.find(name) for name in page.models]
    examples = _examples(report, table, test_set, models[0])
    for axes, photograph in zip(figure.subplots(1, 3, sharey=True), examples, strict=True):
        true = ResponseCurve.from_samples(test_set.curves[photograph.curve])
        curves = {"truth": true} | dict(_answers(photograph, test_set, models)) | {GAMMA: ResponseCurve.gamma(2.2)}
        for (name, curve), color in zip(curves.items(), COLORS, strict=True):
            error = "" if name == "truth" else f", {np.linalg.norm(curve.brightness - true.brightness):.2f}"
            axes.plot(IRRADIANCE, curve.brightness, color=color, label=name + error)
        axes.set_xlabel("irradiance")
        axes.legend(fontsize=6, loc="lower right")
    figure.axes[0].set_ylabel("brightness")
    _save(figure, path)


def _examples(report: Report, table: Table, test_set: TestSet, model: Model) -> list[TestPhotograph]:
    """Return the photographs of P0 at the quantiles `EXAMPLES` of a model's E_est."""
    count, seed = report.settings["photographs"], report.settings["seed"]
    photographs = clean_photographs(range(len(test_set.scenes)), range(len(test_set.curves)), count=count, seed=seed)
    rows = table.rows("P0", {model.name: model.key}, [photograph.label for photograph in photographs])
    order = np.argsort([row["E_est"] for row in Cases(rows).first])
    return [photographs[order[round(part * (len(order) - 1))]] for part in EXAMPLES]


def _answers(
    photograph: TestPhotograph, test_set: TestSet, models: Sequence[Model]
) -> Iterator[tuple[str, ResponseCurve]]:
    """Yield the answer of each model for a photograph."""
    photo = Job("P0", (), test_set, ()).photo(photograph.scene, photograph.curve, photograph.condition)
    for model in models:
        network = ResponseNetwork.load(model.folder)
        yield model.name, estimate_response(photo, network=network, prior=Prior.load(PRIOR)).curve


def _figure() -> Figure:
    """Return an empty figure."""
    mpl.rcParams.update({"font.size": 8, "svg.hashsalt": "crfnet"})
    figure = Figure(figsize=SIZE, dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _save(figure: Figure, path: Path) -> None:
    """Write a figure as PNG, without a date."""
    with atomic_write(path, overwrite=True) as temporary:
        figure.savefig(temporary, format="png", metadata={"Software": None})


def _errors(row: ReportRow) -> str:
    """Return E_est with its interval, and E_lin in parentheses."""
    if not row:
        return ""
    linearization = row["E_lin mean"]
    stated = f"{linearization[0]:.2f}" if isinstance(linearization, list | tuple) else f"{linearization:.3f}"
    return f"{_interval(row['E_est mean'])} ({stated})"


def _interval(figure: Any, decimals: int = 2) -> str:
    """Return a figure, with its interval where it has one."""
    if not isinstance(figure, list | tuple):
        return f"{figure:.3f}"
    return "{:.{d}f} [{:.{d}f}, {:.{d}f}]".format(*figure, d=decimals)


def _percent(figure: Any) -> str:
    """Return a fraction with its interval in percent."""
    return "{:.0f} % [{:.0f}, {:.0f}]".format(*(100 * part for part in figure))


def _stated(figures: paper.PaperFigures) -> str:
    """Return figures of the paper."""
    return f"{figures.estimation} ({figures.linearization})"


def _gamma(report: Report) -> str:
    """Return the errors of gamma 2.2 on P0, ours and the paper's."""
    return f"{_errors(report.row('P0', GAMMA))}; the paper {_stated(paper.GAMMA)}"


def main() -> None:
    """Write the page and its plots."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf and linear")
    parser.add_argument("--out", type=Path, required=True, help="folder of the table and the report")
    parser.add_argument("--page", type=Path, required=True, help="the page to write")
    options = parser.parse_args()
    report = read_report(options.out / "report.json")
    settings = {name: report.settings[name] for name in ("seed", "test_set")}
    table = Table(options.out / TABLE_FILE, settings, code_digest())
    atomic_write_text(options.page, page_text(report), overwrite=True)
    draw_stress(options.page.with_name("PAPER-stress.png"), report)
    draw_curves(options.page.with_name("PAPER-curves.png"), report, options.data, table)
    print(f"wrote {options.page}")


if __name__ == "__main__":
    main()
