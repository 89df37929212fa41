"""report.md: the report in words and tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

from training.evaluation.baselines import GAMMA
from training.evaluation.report import paper
from training.evaluation.report.content import (
    CleanReport,
    GroupSummary,
    MeasuredModel,
    OtherKindReport,
    Reliability,
    Report,
)
from training.evaluation.report.markdown_stress import stress_section
from training.evaluation.report.markdown_tables import (
    COLUMNS,
    bold,
    differences_table,
    error_header,
    mean_cells,
    overall_table,
    quoted,
    rows_of,
    summary_cells,
)
from training.evaluation.report.real.markdown import real_section
from training.evaluation.report.unusual import unusual_section

INTRODUCTION = """# How accurate the models are

- E_est is the L2 distance between the true and the estimated response at 1024 uniform irradiances.
- E_lin (x 1e-2) is the RMSE between the photograph linearised by the true and by the estimated inverse response,
  relative to the peak of the former; PSNR is that of the mean E_lin.
- "shape" is the shape error in stops: how far the linear light of codes 16 to 240 is off, RMS, once the exposure has
  been matched. This is the error that a compositor sees.
- "p90" is the 90th percentile; "ratio" is the mean divided by that of gamma 2.2 on the same photographs; "wins" is the
  fraction of photographs on which gamma 2.2 is worse.
- [Brackets] hold 95 % bootstrap intervals; scenes and responses are resampled together. A difference whose interval
  contains 0 is a tie.
- All estimates come from `crfnet.estimate_response`, as users have it. "Paper" is the CRF-net paper
  (Li & Peers, 2017), on photographs of its own.
"""

TITLES = {
    "P0": "P0: known responses, unseen photographs",
    "P2": "P2: unseen responses, unseen photographs",
}

RELIABILITY_TEXT = """\
Every estimate says how large it expects E_est and the shape error in stops to be. The band is one of the response; it
should cover 0.9 of the true one, and stands in the rows of both errors. "Rejection area" is the mean error of what is
kept, averaged over all fractions rejected, the most uncertain first; "oracle" rejects the largest errors first; "gain"
is how much of the way from random rejection to the oracle it goes (1 is best, 0 says nothing).
"""


def report_text(report: Report) -> str:
    """Return report.md."""
    models = list(report.models)
    parts = [INTRODUCTION, _models(report)]
    if report.p0:
        parts += _clean("P0", report.p0, models)
    if report.p1:
        parts += _other_kind(report.p1)
    if report.p2:
        parts += _clean("P2", report.p2, models)
    if report.p3:
        parts += stress_section(report.p3, models)
    if report.p4:
        parts += real_section(report.p4, models)
    if report.p5:
        parts += _reliability(report.p5)
    if report.p6:
        parts += unusual_section(report.p6, report.p4)
    return "\n".join(parts).rstrip("\n") + "\n"


def _models(report: Report) -> str:
    """Return what was measured."""
    rows = [[name, f"`{model.sha256[:12]}`", _training(model)] for name, model in report.models.items()]
    notes = "".join(f"\n- {note}" for note in report.notes)
    settings = ", ".join(f"{key.replace('_', ' ')} {value}" for key, value in asdict(report.settings).items())
    return rows_of(["model", "sha256", "trained on"], rows) + f"\nSettings: {settings}.\n{notes}\n"


def _training(model: MeasuredModel) -> str:
    """Return what a model says it was trained on."""
    kinds = ", ".join(f"{kind}s" for kind in model.scene_kinds or ()) or "kinds of scene not stated"
    held_out = len(model.held_out_curves)
    return f"{kinds}; {f'{held_out} curves held out' if held_out else 'all curves'}"


def _clean(name: str, report: CleanReport, models: Sequence[str]) -> list[str]:
    """Return the section of P0 or P2."""
    kind = "groups of curves held out of training" if name == "P2" else "every curve may be in training"
    counts = f"{report.overall.photographs} photographs: {len(report.scenes)} scenes, {report.curves} responses"
    kinds = {f"all of kind {group}": summary for group, summary in report.kinds.items()}
    return [
        f"## {TITLES[name]}\n",
        f"{counts}, five exposures; {kind}.\n",
        overall_table(report.overall.estimators, models, with_paper=name == "P0"),
        *differences_table(("", difference) for difference in report.differences),
        f"### {name} by exposure\n",
        "The exposure is a factor on s_crf (the paper's Table 2; its overall figure stands at 1).\n",
        _by_exposure(report.exposures, models),
        f"### {name} by scene\n",
        _by_scene(report.scenes | kinds, models),
    ]


def _by_exposure(groups: dict[str, GroupSummary], models: Sequence[str]) -> str:
    """Return the errors at every exposure, beside the paper's."""
    names, rows = [*models, GAMMA], []
    for factor, group in groups.items():
        figures = paper.STRESS.get(f"exposure {factor}", paper.OVERALL if factor == "1" else None)
        cells = [cell for name in names for cell in mean_cells(group.estimators[name])]
        rows.append([factor, str(group.photographs), quoted(figures), *cells])
    return rows_of(["factor", "n", "paper", *error_header(names)], rows)


def _by_scene(groups: dict[str, GroupSummary], models: Sequence[str]) -> str:
    """Return the mean errors of every scene."""
    names, rows = [*models, GAMMA], []
    for scene, group in groups.items():
        errors = [error for name in names for _, error in group.estimators[name].errors.items()]
        cells = [f"{error.mean.value:.2f}" for error in errors]
        rows.append([scene, group.kind, str(group.photographs), *cells])
    return rows_of(["scene", "kind", "n", *error_header(names)], rows)


def _other_kind(report: dict[str, OtherKindReport]) -> list[str]:
    """Return the section of P1."""
    rows, lines = [], []
    for model, part in report.items():
        kind, photographs = part.group.kind, part.group.photographs
        if part.is_strict:
            lines.append(f"- {model}: trained on no {kind}, measured on {kind}s only.")
        else:
            lines.append(f"- {model}: trained on both kinds, so **this is not the strict protocol**: {kind}s only.")
        if not photographs:
            lines.append(f"- {model}: there are no such scenes here.")
        for name, summary in part.group.estimators.items():
            cells = summary_cells(summary, is_reference=name == GAMMA)
            rows.append([bold(name, [model]), kind, str(photographs), *cells])
    text = rows_of(["", "scenes", "n", *COLUMNS], rows) if rows else ""
    few = "Its test scenes are few; the intervals say so.\n" if rows else ""
    return ["## P1: photographs of another kind than in training\n", "\n".join(lines) + "\n", text, few]


def _reliability(report: dict[str, dict[str, dict[str, Reliability]]]) -> list[str]:
    """Return the section of P5."""
    measured = [
        (error, protocol, model, row)
        for error, protocols in report.items()
        for protocol, models in protocols.items()
        for model, row in models.items()
    ]
    counts = [[*names, *_reliability_cells(row)] for *names, row in measured]
    header = ["mean uncertainty", "mean error", "rank correlation", "band coverage"]
    header += ["rejection area", "rejection area, oracle", "rejection area, random", "gain"]
    most = max(len(row.bins) for *_, row in measured)
    bins = []
    for *names, row in measured:
        pairs = [f"{part.uncertainty:.2f} / {part.error:.2f}" for part in row.bins]
        bins.append([*names, *pairs, *[""] * (most - len(pairs))])
    return [
        "## P5: reliability of the uncertainty\n",
        RELIABILITY_TEXT,
        rows_of(["error", "", "model", "photographs", *header], counts),
        "Mean uncertainty / mean error of groups of equal size, from the least to the most uncertain:\n",
        rows_of(["error", "", "model", *(str(k + 1) for k in range(most))], bins),
    ]


def _reliability_cells(row: Reliability) -> list[str]:
    """Return the figures of one model in one protocol."""
    figures = (
        *(row.mean_uncertainty, row.mean_error, row.rank_correlation, row.band_coverage),
        *(row.rejection_area, row.oracle_area, row.random_area, row.gain),
    )
    return [str(row.photographs), *(f"{figure:.4g}" for figure in figures)]
