r"""Write docs/PAPER.md: each number of the CRF-net paper beside ours.

    python -m training.evaluation --data DATA --out OUT --model photograph-statistics-2.4 crfnet2017 \
        --protocol p0 paper p4 --photographs 402
    python -m training.evaluation.paper_page --data DATA --out OUT --page docs/PAPER.md

The second command reads OUT/report.json and the table beside it, and draws PAPER-curves.png and PAPER-stress.png beside
the page. The first model is the default, the second the paper's network.
"""

import argparse
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from crfnet_core.estimate.estimate import estimate_response
from crfnet_core.files import atomic_write, atomic_write_text
from crfnet_core.posterior import Prior
from crfnet_core.response.curve import UNIFORM, ResponseCurve
from training.evaluation.baselines import GAMMA, OTHER_BODIES
from training.evaluation.measure.simulated import PAPER, PRIOR, WAYS, simulated_photo
from training.evaluation.measure.table import TABLE_FILE, Table
from training.evaluation.models import Model, load_network
from training.evaluation.plan import SEED, TestPhotograph, clean_photographs
from training.evaluation.report import paper
from training.evaluation.report.document import Report, read_report, value
from training.evaluation.report.markdown import markdown_rows
from training.evaluation.test_sets import TestSet, dorf_test_set
from training.synthesis.camera import EXPOSURE_FACTORS

#: The text of the page around its tables and plots; the names in braces are filled in.
TEMPLATE = Path(__file__).with_name("paper_page.md")

#: Head of a group of rows -> label of a row -> condition of the protocol `PAPER`.
EXPERIMENTS: dict[str, dict[str, str]] = {
    "Table 2: exposure": {
        f"{factor:.1f}": "clean" if factor == 1 else f"exposure {factor:g}" for factor in EXPOSURE_FACTORS
    },
    "Sec. 5.2: resolution": {f"{times}x": f"resolution {times}x" for times in (1, 2, 4)},
    "Sec. 5.3:": {"without color": "grayscale"},
    "Table 3: noise": {each: f"noise variance {each}" for each in ("0.5", "1", "2", "4")},
    "Table 4: blur": {each: f"blur variance {each}" for each in ("1", "2", "4", "8")},
    "Fig. 7: severe exposure": {each: f"exposure {each}" for each in ("0.15", "4")},
    "Fig. 8: white balance": {each: f"{each} white balance" for each in ("cool", "warm")},
}

#: Heads of groups that are plotted -> the word under the axis, and places on it -> conditions.
PLOTTED = {
    "exposure, times s_crf": EXPERIMENTS["Table 2: exposure"],
    "variance of the noise": {"0": "clean"} | EXPERIMENTS["Table 3: noise"],
    "variance of the blur": {"0": "clean"} | EXPERIMENTS["Table 4: blur"],
}

#: Quantiles of the network's E_est on P0: of the photographs whose curves are drawn.
EXAMPLES = (0.1, 0.5, 0.9)

#: Size of the plots in inches, their resolution, and the colors of truth and estimators.
SIZE, DPI, COLORS = (9.0, 2.9), 80, ("#7b3294", "#1b9e3c", "#d95f02", "#808080")


def page_text(report: Report) -> str:
    """Return the page."""
    network, default = _models(report)
    overall = report.row("P0", network)
    return TEMPLATE.read_text(encoding="utf-8").format(
        network=network,
        default=default,
        ratio=value(overall["E_est ratio"]),
        photographs=overall["photographs"],
        stressed=report.row(PAPER, GAMMA, "clean")["photographs"],
        bodies=report.row("P4 both", GAMMA)["bodies"],
        experiments=markdown_rows(_experiments(report)),
        wins=markdown_rows(_wins(report)),
        windows=markdown_rows(_windows(report)),
        real=markdown_rows(_real(report)),
    )


def _models(report: Report) -> tuple[str, str]:
    """Return the paper's network and the default model."""
    default, network = report.models
    return network, default


def _experiments(report: Report) -> Iterator[list[str]]:
    """Yield the rows of all conditions."""
    gamma = f"{_errors(report, 'P0', GAMMA)}; the paper {_stated(paper.GAMMA)}"
    overall = (_errors(report, "P0", name) for name in _models(report))
    yield ["Sec. 4: all photographs", _stated(paper.OVERALL), *overall, gamma]
    for head, conditions in EXPERIMENTS.items():
        for label, condition in conditions.items():
            estimators = (paper.PAPER, *_models(report), GAMMA)
            yield [f"{head} {label}", *(_errors(report, PAPER, name, condition) for name in estimators)]


def _wins(report: Report) -> Iterator[list[str]]:
    """Yield the rows of Sec. 5.6."""
    for name in _models(report):
        rates = (report.row("P0", name)[f"{error} win rate"] for error in ("E_est", "E_lin"))
        yield [name, *("{:.0f} % [{:.0f}, {:.0f}]".format(*(100 * part for part in rate)) for rate in rates)]


def _windows(report: Report) -> Iterator[list[str]]:
    """Yield the rows of Fig. 3 and Fig. 9."""
    for name in _models(report):
        ways = (_errors(report, PAPER, name + way, "clean") for way in (*WAYS, ""))
        clean = report.row(PAPER, name, "clean")
        yield [name, *ways, *(_interval(clean[f"{part} mean"]) for part in ("lower", "partial"))]


def _real(report: Report) -> Iterator[list[str]]:
    """Yield the rows of Fig. 6."""
    for name in (*_models(report), OTHER_BODIES, GAMMA):
        row = report.row("P4 both", name)
        yield [name, _interval(row["E_est mean"]), _interval(row["shape mean"], 3), f"{value(row['E_lin mean']):.2f}"]


def _errors(report: Report, table: str, estimator: str, group: str = "") -> str:
    """Return E_est with its interval, and E_lin in parentheses; nothing where they are not measured."""
    if not (row := report.row(table, estimator, group)):
        return ""
    if estimator == paper.PAPER:
        return f"{row['E_est mean']:.3f} ({row['E_lin mean']:.3f})"
    return f"{_interval(row['E_est mean'])} ({value(row['E_lin mean']):.2f})"


def _interval(figure: Sequence[float], decimals: int = 2) -> str:
    """Return a figure with its interval."""
    return "{:.{d}f} [{:.{d}f}, {:.{d}f}]".format(*figure, d=decimals)


def _stated(figures: paper.PaperFigures) -> str:
    return f"{figures.estimation} ({figures.linearization})"


def draw_stress(path: Path, report: Report) -> None:
    """Draw E_est against exposure, noise and blur."""
    figure = _figure()
    for axes, (word, conditions) in zip(figure.subplots(1, 3, sharey=True), PLOTTED.items(), strict=True):
        for name, color in zip((paper.PAPER, *_models(report), GAMMA), COLORS, strict=True):
            errors = [value(report.row(PAPER, name, each).get("E_est mean", np.nan)) for each in conditions.values()]
            axes.plot([float(place) for place in conditions], errors, "o-", color=color, label=name)
        axes.set_xlabel(word)
    figure.axes[0].set_ylim(bottom=0)  # for all, once each has widened the range
    figure.axes[0].set_ylabel("E_est")
    figure.axes[0].legend(fontsize=7)
    _save(figure, path)


def draw_curves(path: Path, report: Report, data: Path, table: Table) -> None:
    """Draw the responses of `EXAMPLES`: true, of both models, and gamma 2.2."""
    test_set, figure = dorf_test_set(data), _figure()
    models = [Model.find(name) for name in _models(report)]
    examples = _examples(report, table, test_set, models[0])
    for axes, photograph in zip(figure.subplots(1, 3, sharey=True), examples, strict=True):
        true = ResponseCurve.from_samples(test_set.curves[photograph.curve])
        ask = partial(estimate_response, simulated_photo(test_set, photograph), prior=Prior.load(PRIOR))
        answers = {model.name: ask(network=load_network(model)).curve for model in models}
        curves = {"truth": true} | answers | {GAMMA: ResponseCurve.gamma(2.2)}
        for (name, curve), color in zip(curves.items(), COLORS, strict=True):
            error = "" if name == "truth" else f", {np.linalg.norm(curve.brightness - true.brightness):.2f}"
            axes.plot(UNIFORM, curve.brightness, color=color, label=name + error)
        axes.set_xlabel("irradiance")
        axes.legend(fontsize=6, loc="lower right")
    figure.axes[0].set_ylabel("brightness")
    _save(figure, path)


def _examples(report: Report, table: Table, test_set: TestSet, model: Model) -> list[TestPhotograph]:
    """Return the photographs of P0 at the quantiles `EXAMPLES` of a model's E_est."""
    scenes, curves = range(len(test_set.scenes)), range(len(test_set.curves))
    photographs = clean_photographs(scenes, curves, count=report.settings["photographs"])
    rows = table.rows("P0", {model.name: model.key}, [photograph.label for photograph in photographs])
    order = np.argsort([row["E_est"] for row in rows[model.name]])
    return [photographs[order[round(part * (len(order) - 1))]] for part in EXAMPLES]


def _figure() -> Figure:
    mpl.rcParams["font.size"] = 8
    return Figure(figsize=SIZE, dpi=DPI, layout="constrained")


def _save(figure: Figure, path: Path) -> None:
    """Write a figure as PNG, without a date."""
    with atomic_write(path, overwrite=True) as temporary:
        figure.savefig(temporary, format="png", metadata={"Software": None})


def main() -> None:
    """Write the page and its plots."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf and linear")
    parser.add_argument("--out", type=Path, required=True, help="folder of the table and the report")
    parser.add_argument("--page", type=Path, required=True, help="the page to write")
    options = parser.parse_args()
    report = read_report(options.out / "report.json")
    table = Table(options.out / TABLE_FILE, {"seed": SEED, "test_set": report.settings["test_set"]})
    atomic_write_text(options.page, page_text(report), overwrite=True)
    draw_stress(options.page.with_name("PAPER-stress.png"), report)
    draw_curves(options.page.with_name("PAPER-curves.png"), report, options.data, table)
    print(f"wrote {options.page}")


if __name__ == "__main__":
    main()
