"""Sum up P0, P1 and P2: clean photographs through known and unseen responses, and of another kind of scene."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from training.evaluation.baselines import GAMMA
from training.evaluation.plan import TestPhotograph
from training.evaluation.report.content import CleanReport, GroupSummary, MeasuredModel, OtherKindReport
from training.evaluation.summaries.error_table import ErrorTable
from training.evaluation.test_sets import TestSet

#: The kinds of scene.
KINDS = ("panorama", "photograph")


def clean_report(
    photographs: Sequence[TestPhotograph], table: ErrorTable, models: Sequence[str], test_set: TestSet
) -> CleanReport:
    """Return the report of P0 or P2: of all photographs, by exposure, by scene and by kind of scene."""
    factors = np.array([photograph.condition.factor for photograph in photographs])
    scenes = np.array([photograph.scene for photograph in photographs])
    kinds = np.array([test_set.scenes[k].kind for k in scenes])
    estimators = [*models, GAMMA]
    return CleanReport(
        overall=table.group(table.names(models)),
        differences=table.differences(models),
        curves=len({photograph.curve for photograph in photographs}),
        exposures={f"{factor:g}": table.subset(factors == factor).group(estimators) for factor in np.unique(factors)},
        scenes={
            test_set.scenes[k].name: table.subset(scenes == k).group(estimators, kind=test_set.scenes[k].kind)
            for k in np.unique(scenes)
        },
        kinds={str(kind): table.subset(kinds == kind).group(estimators, kind=str(kind)) for kind in np.unique(kinds)},
    )


def other_kind_report(
    photographs: Sequence[TestPhotograph], table: ErrorTable, models: dict[str, MeasuredModel], test_set: TestSet
) -> dict[str, OtherKindReport]:
    """Return the report of P1: for every model, the P0 photographs of scenes of a kind that it was not trained on.

    A model that saw both kinds, or does not say, gets the perspective photographs. This is not the strict protocol.

    Parameters
    ----------
    photographs : sequence of TestPhotograph
        Those of P0.
    table : ErrorTable
        Their errors.
    models : dict
        Name -> model.
    test_set : TestSet
        For the kinds of the scenes.
    """
    kinds = np.array([test_set.scenes[photograph.scene].kind for photograph in photographs])
    report = {}
    for name, model in models.items():
        trained_on = KINDS if model.scene_kinds is None else model.scene_kinds
        unseen = [kind for kind in KINDS if kind not in trained_on]
        kind = unseen[0] if unseen else "photograph"
        chosen = kinds == kind
        group = table.subset(chosen).group([name, GAMMA], kind=kind) if chosen.any() else GroupSummary(0, {}, kind)
        scenes = {photograph.scene for photograph, is_chosen in zip(photographs, chosen, strict=True) if is_chosen}
        report[name] = OtherKindReport(group, len(scenes), is_strict=bool(unseen))
    return report
