import pytest

pytest.importorskip("torch", reason="training needs the train extra")
from training.evaluation.baselines import GAMMA, OTHER_BODIES
from training.evaluation.measure.simulated import PAPER, WAYS
from training.evaluation.paper_page import EXPERIMENTS, draw_stress, page_text
from training.evaluation.report import paper
from training.evaluation.report.document import Report

MODELS = ("statistics", "network")

FIGURES = {
    f"{error} {name}": [1.5, 1.0, 2.0]
    for error in ("E_est", "E_lin", "shape")
    for name in ("mean", "ratio", "win rate")
} | {"lower mean": [0.7, 0.6, 0.8], "partial mean": [0.4, 0.3, 0.5]}


@pytest.fixture(scope="module")
def report():
    """A report in which every error of ours is 1.5."""
    conditions = [group for conditions in EXPERIMENTS.values() for group in conditions.values()]
    ours = [("P0", "", name) for name in (*MODELS, GAMMA)]
    ours += [("P4 both", "", name) for name in (*MODELS, OTHER_BODIES, GAMMA)]
    ours += [(PAPER, "clean", name + way) for name in MODELS for way in WAYS]
    ours += [(PAPER, group, name) for group in conditions for name in (*MODELS, GAMMA)]
    names = ("table", "group", "estimator")
    rows = [dict(zip(names, row, strict=True)) | {"photographs": 9, "bodies": 4} | FIGURES for row in ours]
    stated = [(PAPER, group, paper.PAPER) for group in conditions if group in paper.STRESS]
    for row in stated:
        figures = {"E_est mean": paper.STRESS[row[1]].estimation, "E_lin mean": paper.STRESS[row[1]].linearization}
        rows.append(dict(zip(names, row, strict=True)) | figures)
    return Report({"photographs": 9, "seed": 1}, dict.fromkeys(MODELS, "0" * 64), [], rows)


@pytest.mark.parametrize("group", paper.STRESS)
def test_every_figure_of_the_paper_stands_beside_ours(report, group):
    figures = paper.STRESS[group]
    start = f"{figures.estimation:.3f} ({figures.linearization:.3f}) | 1.50 [1.00, 2.00] (1.50) |"
    assert start in page_text(report)


def test_the_published_page_has_every_figure_of_the_paper(root):
    text = (root / "docs" / "PAPER.md").read_text(encoding="utf-8")
    assert [group for group, one in paper.STRESS.items() if f"{one.estimation:.3f} (" not in text] == []


def test_the_page_counts_wins_in_percent(report):
    assert "| network | 150 % [100, 200] | 150 % [100, 200] |" in page_text(report)


def test_the_plot_is_a_small_picture(report, tmp_path):
    draw_stress(tmp_path / "plot.png", report)
    assert (tmp_path / "plot.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "plot.png").stat().st_size < 75_000
