"""The report in words and tables, from report.json's contents alone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from training.evaluation import paper
from training.evaluation.baselines import GAMMA, OTHER_CAMERAS
from training.evaluation.markdown_tables import (
    COLUMNS,
    bold,
    cells_of,
    differences_table,
    overall_table,
    quoted,
    rows_of,
    shown,
)

Table = dict[str, Any]

INTRODUCTION = """# How accurate the models are

E_est is the L2 distance between the true and the estimated response at 1024 uniform irradiances; E_lin (x 1e-2) the
RMSE between the photograph linearised by the true and by the estimated inverse, relative to the peak of the former;
"ratio" the mean divided by that of gamma 2.2 on the same photographs; "wins" the share of photographs on which gamma
2.2 is worse. [Brackets] hold 95 % bootstrap intervals; scenes and curves are resampled together. A difference whose
interval contains 0 is a tie. All estimates come from `crfnet_core.estimate.estimate_response` as users have it. "Paper"
is the CRF-net paper (Li & Peers, 2017), on photographs of its own.
"""


def report_text(report: Table) -> str:
    """Return report.md for the contents of report.json."""
    models = list(report["models"])
    parts = [INTRODUCTION, _models(report)]
    sections = {"P0": _plain, "P1": _other_kind, "P2": _plain, "P3": _stress, "P4": _real, "P5": _calibration}
    for name, section in sections.items():
        if name in report:
            parts += section(name, report[name], models)
    return "\n".join(parts).rstrip("\n") + "\n"


def _models(report: Table) -> str:
    """Return what was measured."""
    rows = [
        [name, f"`{model['sha256'][:12]}`", _training(model["training"])] for name, model in report["models"].items()
    ]
    notes = "".join(f"\n- {note}" for note in report["notes"])
    settings = ", ".join(f"{key} {value}" for key, value in report["settings"].items())
    return rows_of(["model", "sha256", "trained on"], rows) + f"\nSettings: {settings}.\n{notes}\n"


def _training(entry: Table) -> str:
    """Return what a model says it was trained on."""
    kinds = ", ".join(f"{kind}s" for kind in entry.get("scene_kinds", [])) or "kinds of scene not stated"
    held_out = entry.get("held_out_curves") or []
    return f"{kinds}; {f'{len(held_out)} curves held out' if held_out else 'all curves'}"


TITLES = {
    "P0": "P0: known responses, unseen photographs",
    "P2": "P2: unseen responses, unseen photographs",
}


def _plain(name: str, table: Table, models: Sequence[str]) -> list[str]:
    """Return the section of P0 or P2."""
    scenes, curves = len(table["scenes"]), table["curves"]
    kind = "groups of curves held out of training" if name == "P2" else "every curve may be in training"
    return [
        f"## {TITLES[name]}\n",
        f"{table['photographs']} photographs: {scenes} scenes, {curves} responses, five exposures; {kind}.\n",
        overall_table(table, models, with_paper=name == "P0"),
        *differences_table(table["differences"]),
        f"### {name} by exposure\n",
        "The exposure is a factor on s_crf (the paper's Table 2; its overall figure stands at 1).\n",
        _by_exposure(table["exposures"], models),
        f"### {name} by scene\n",
        _by_scene(table["scenes"] | {f"all of kind {kind}": row for kind, row in table["kinds"].items()}, models),
    ]


def _by_exposure(table: Table, models: Sequence[str]) -> str:
    """Return E_est and E_lin at every exposure, beside the paper's."""
    names = [*models, GAMMA]
    header = ["factor", "n", "paper", *(f"{name}: {error}" for name in names for error in ("E_est", "E_lin"))]
    rows = []
    for factor, row in table.items():
        figures = paper.STRESS.get(f"exposure {factor}", paper.OVERALL if factor == "1" else None)
        cells = [shown(row["estimators"][name][f"{error} mean"]) for name in names for error in ("E_est", "E_lin")]
        rows.append([factor, str(row["photographs"]), quoted(figures), *cells])
    return rows_of(header, rows)


def _by_scene(table: Table, models: Sequence[str]) -> str:
    """Return mean E_est of every scene."""
    names = [*models, GAMMA]
    header = ["scene", "kind", "n", *(f"{name}: E_est" for name in names), *(f"{name}: E_lin" for name in names)]
    rows = []
    for scene, row in table.items():
        cells = [f"{row['estimators'][name][f'{e} mean']['value']:.2f}" for e in ("E_est", "E_lin") for name in names]
        rows.append([scene, row.get("kind", ""), str(row["photographs"]), *cells])
    return rows_of(header, rows)


def _other_kind(_name: str, table: Table, _models: Sequence[str]) -> list[str]:
    """Return the section of P1."""
    rows, lines = [], []
    for model, row in table.items():
        if row["is_strict"]:
            lines.append(f"- {model}: trained on no {row['kind']}, measured on {row['kind']}s only.")
        else:
            lines.append(
                f"- {model}: trained on both kinds, so **this is not the strict protocol**: {row['kind']}s only."
            )
        if not row["photographs"]:
            lines.append(f"- {model}: there are no such scenes here.")
            continue
        for name, figures in row["estimators"].items():
            rows.append(
                [
                    bold(name, [model]),
                    row["kind"],
                    str(row["photographs"]),
                    *cells_of(figures, is_reference=name == GAMMA),
                ]
            )
    text = rows_of(["", "scenes", "n", *COLUMNS], rows) if rows else ""
    few = "Its test scenes are few; the intervals say so.\n" if rows else ""
    return ["## P1: photographs of another kind than in training\n", "\n".join(lines) + "\n", text, few]


STRESS_TEXT = """{photographs} photographs of P0 at exposure s_crf, under every condition; "x clean" is the ratio to the
clean ones, "tie" a difference to them whose interval contains 0. Our readings where the paper is short of words: noise
is Gaussian, added after the response and before quantisation, its variance in squared 8-bit codes; blur a Gaussian in
linear light, its variance in squared pixels; "resolution" the linear scene enlarged by cubic interpolation; cool white
balance gains of (0.6, 1, 1.7) in linear light at equal luminance, warm (1.7, 1, 0.6); JPEG with subsampled chroma.
"""


def _stress(_name: str, table: Table, models: Sequence[str]) -> list[str]:
    """Return the section of P3."""
    conditions = _conditions(table["conditions"], models)
    parts = ["## P3: stress\n", STRESS_TEXT.format(**table), conditions]
    parts += _many_differences(table["differences"], table["conditions"])
    if table["trials"]:
        parts += ["### Windows and photographs\n", TRIALS_TEXT, _trials(table["trials"], table["conditions"], models)]
        parts += _many_differences(table["differences"], table["trials"])
    rows = [[bold(name, models), *(shown(figure) for figure in row.values())] for name, row in table["partial"].items()]
    header = ["", *next(iter(table["partial"].values()))]
    return [*parts, "### The lower 80 % of the irradiance (paper, Fig. 9)\n", PARTIAL_TEXT, rows_of(header, rows)]


TRIALS_TEXT = """The clean photographs, asked otherwise. "Random windows" need fill no number of bins; the product's
default asks for many. The two rows of averages are of the windows' own estimates, whatever the product makes of them.
Pooled photographs show other scenes through the same response; E_lin is that of the first.
"""

PARTIAL_TEXT = "Both curves as they are, not rescaled; the clean photographs.\n"


def _conditions(table: Table, models: Sequence[str]) -> str:
    """Return the conditions beside the paper's figures."""
    header = ["condition", "paper", "x clean"]
    for name in models:
        header += [f"{name}: E_est", "x clean", "E_lin", "x clean"]
    rows = []
    for condition, row in table.items():
        figures = paper.STRESS.get(condition)
        cells = [condition, quoted(figures) or paper.IN_WORDS.get(condition, ""), _paper_to_clean(figures)]
        for name in models:
            cells += _to_clean(row[name], is_clean=condition == "clean")
        rows.append([*cells, f"{row[GAMMA]['E_lin mean']['value']:.2f}"])
    return rows_of([*header, f"{GAMMA}: E_lin"], rows)


def _paper_to_clean(figures: paper.PaperFigures | None) -> str:
    """Return the paper's ratios to its overall figures."""
    if figures is None:
        return ""
    estimation = figures.estimation / paper.OVERALL.estimation
    return f"{estimation:.2f} / {figures.linearisation / paper.OVERALL.linearisation:.2f}"


def _to_clean(row: Table, *, is_clean: bool) -> list[str]:
    """Return both errors and their ratios to the clean ones."""
    cells = []
    for error in ("E_est", "E_lin"):
        tie = ", tie" if row[f"{error} verdict"] == "tie" and not is_clean else ""
        cells += [shown(row[f"{error} mean"]), "1" if is_clean else shown(row[f"{error} to clean"]) + tie]
    return cells


def _trials(table: Table, conditions: Table, models: Sequence[str]) -> str:
    """Return the trials beside the plain question."""
    header = ["question"]
    for name in models:
        header += [f"{name}: E_est", "difference", "verdict", "E_lin", "difference", "verdict"]
    plain = ["as the product is"]
    for name in models:
        row = conditions["clean"][name]
        plain += [shown(row["E_est mean"]), "", "", shown(row["E_lin mean"]), "", ""]
    rows = [plain]
    for trial, row in table.items():
        cells = [trial]
        for name in models:
            for error in ("E_est", "E_lin"):
                found = row[name]
                cells += [shown(found[f"{error} mean"]), shown(found[f"{error} difference"]), found[f"{error} verdict"]]
        rows.append(cells)
    return rows_of(header, rows)


def _many_differences(table: Table, names: Iterable[str]) -> list[str]:
    """Return the differences between models under every condition, if there are several models."""
    rows = [
        [name, " - ".join(row["models"]), row["error"], shown(row["difference"]), row["verdict"]]
        for name in names
        for row in table[name]
    ]
    if not rows:
        return []
    return ["Paired differences between models:\n", rows_of(["", "models", "error", "difference", "verdict"], rows)]


def _real(_name: str, table: Table, models: Sequence[str]) -> list[str]:
    """Return the section of P4."""
    trusted, low, high = table["trusted"], *paper.REAL_RANGE
    names = [*models, GAMMA]
    cameras = []
    for camera, row in table["cameras"].items():
        cells = [f"{row['estimators'][name]['E_est']:.2f}" for name in names]
        doubts = [f"{row['estimators'][name]['uncertainty']:.2f}" for name in models]
        linear = [f"{row['estimators'][name]['E_lin']:.2f}" for name in names]
        cameras.append([camera, row["grades"], str(row["photographs"]), *cells, *doubts, *linear])
    header = [f"{name}: E_est" for name in names] + [f"{name}: expected" for name in models]
    header += [f"{name}: E_lin" for name in names]
    return [
        "## P4: real photographs\n",
        f"Means over cameras. Of {table['photographs']} photographs, {trusted['photographs']} of {trusted['cameras']}"
        " cameras have a response measured well enough to count (grades A and B). The paper's Fig. 6 has 8 real"
        f" photographs, E_est {low} to {high}. Whoever knows other cameras (another body of the same model, too) but"
        f' does not look at the photograph is "{OTHER_CAMERAS}".\n',
        f"### Grades A and B: {trusted['cameras']} cameras\n",
        overall_table(trusted, models, with_paper=False),
        *differences_table(trusted["differences"]),
        f"### All grades: {table['all']['cameras']} cameras\n",
        overall_table(table["all"], models, with_paper=False),
        "### By camera\n",
        rows_of(["camera", "grade", "n", *header], cameras),
    ]


def _calibration(_name: str, table: Table, _models: Sequence[str]) -> list[str]:
    """Return the section of P5."""
    rows, bins = [], []
    keys = ["photographs", "mean uncertainty", "mean error", "rank correlation", "band coverage"]
    areas = ["rejection area", "rejection area, oracle", "rejection area, random", "gain"]
    for protocol, models in table.items():
        for model, row in models.items():
            rows.append([protocol, model, *(f"{row[key]:g}" for key in (*keys, *areas))])
            pairs = [f"{part['uncertainty']:.2f} / {part['error']:.2f}" for part in row["bins"]]
            bins.append([protocol, model, *pairs, *[""] * (8 - len(pairs))])
    return [
        "## P5: calibration of the uncertainty\n",
        "The band should cover 0.9 of the true response. Rejection area: mean error of what is kept, over all shares"
        " rejected, most uncertain first; gain: how much of the way from random to oracle (1 is best, 0 says nothing)."
        "\n",
        rows_of(["", "model", *keys, *areas], rows),
        "Mean uncertainty / mean error, from the least to the most uncertain eighth:\n",
        rows_of(["", "model", *(str(k + 1) for k in range(8))], bins),
    ]
