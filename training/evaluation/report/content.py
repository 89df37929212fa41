"""What a report holds, as dataclasses: report.json, report.md and the plots are all made from these."""

from __future__ import annotations

from dataclasses import dataclass

from training.evaluation.report.errors import Comparison, EstimatorDifference, EstimatorSummary, Interval, PerError
from training.evaluation.report.real.content import RealReport
from training.evaluation.report.unusual import UnusualReport


@dataclass(frozen=True)
class GroupSummary:
    """The figures of several estimators, by name, over a group of photographs of one `kind` of scene, or of any."""

    photographs: int
    estimators: dict[str, EstimatorSummary]
    kind: str = ""


@dataclass(frozen=True)
class CleanReport:
    """P0 or P2: clean photographs at five exposures.

    Parameters
    ----------
    overall : GroupSummary
        Of every model and baseline.
    differences : tuple of EstimatorDifference
        Between every two models.
    curves : int
        How many responses there are.
    exposures, scenes, kinds : dict
        The models and gamma 2.2 by factor on the exposure s_crf, by scene, and by kind of scene.
    """

    overall: GroupSummary
    differences: tuple[EstimatorDifference, ...]
    curves: int
    exposures: dict[str, GroupSummary]
    scenes: dict[str, GroupSummary]
    kinds: dict[str, GroupSummary]


@dataclass(frozen=True)
class OtherKindReport:
    """P1 of one model: photographs of another kind of scene than it was trained on.

    Parameters
    ----------
    group : GroupSummary
        The model and gamma 2.2; `kind` is the kind of scene.
    scenes : int
        How many scenes there are.
    is_strict : bool
        Whether the model was trained on no scene of this kind.
    """

    group: GroupSummary
    scenes: int
    is_strict: bool


@dataclass(frozen=True)
class RelativeToClean:
    """An error beside that of the clean photographs under the plain query: ratio of the means, and who is better."""

    ratio: Interval
    comparison: Comparison


@dataclass(frozen=True)
class StressSummary:
    """The figures of one estimator under one condition or query of P3."""

    summary: EstimatorSummary
    to_clean: PerError[RelativeToClean]


@dataclass(frozen=True)
class StressRow:
    """One condition or query of P3: the estimators by name, and the differences between every two models."""

    estimators: dict[str, StressSummary]
    differences: tuple[EstimatorDifference, ...]


@dataclass(frozen=True)
class PartialSummary:
    """E_est over irradiance from 0 to 0.8, over all of it, and the ratio of the two (CRF-net paper, Fig. 9)."""

    lower: Interval
    whole: Interval
    ratio: Interval


@dataclass(frozen=True)
class StressReport:
    """P3: the same photographs under every condition, and the clean ones under every query.

    Parameters
    ----------
    photographs : int
        Under every condition.
    conditions, queries : dict
        By name.
    partial : dict
        Estimator -> figures of the clean photographs.
    """

    photographs: int
    conditions: dict[str, StressRow]
    queries: dict[str, StressRow]
    partial: dict[str, PartialSummary]


@dataclass(frozen=True)
class ReliabilityBin:
    """Photographs of similar uncertainty: mean uncertainty, mean error, and how many they are."""

    uncertainty: float
    error: float
    photographs: int


@dataclass(frozen=True)
class Reliability:
    """How well the uncertainties of one model foretell one of its errors, E_est or the shape error in stops (P5).

    Parameters
    ----------
    photographs : int
        How many there are.
    mean_uncertainty, mean_error : float
        Of the error expected and of the error found.
    rank_correlation : float
        Spearman's, of uncertainty and error.
    band_coverage : float
        Mean fraction of the true response inside the 90 % band; 0.9 is right.
    rejection_area, oracle_area, random_area : float
        Mean error of what is kept, averaged over all fractions rejected: with the most uncertain rejected first, with
        the largest errors rejected first, and with a random choice rejected.
    gain : float
        The part, at most 1, of the way from random to oracle.
    bins : tuple of ReliabilityBin
        Groups of equal size, the least uncertain first.
    """

    photographs: int
    mean_uncertainty: float
    mean_error: float
    rank_correlation: float
    band_coverage: float
    rejection_area: float
    oracle_area: float
    random_area: float
    gain: float
    bins: tuple[ReliabilityBin, ...]


@dataclass(frozen=True)
class MeasuredModel:
    """A model that was measured: the hash of its graph, and what model.json says of its training.

    Parameters
    ----------
    sha256 : str
        Of model.onnx.
    scene_kinds : tuple of str, optional
        Kinds of scene in training; None where model.json does not say.
    held_out_curves : tuple of int
        Numbers of the DoRF curves that were kept out of training.
    """

    sha256: str
    scene_kinds: tuple[str, ...] | None = None
    held_out_curves: tuple[int, ...] = ()


@dataclass(frozen=True)
class ReportSettings:
    """At most how many photographs P0 and P2 have, the seed, and a hash of the scenes and responses."""

    photographs: int
    seed: int
    test_set: str


@dataclass(frozen=True)
class Report:
    """A whole evaluation; a protocol that was not run is None.

    Parameters
    ----------
    settings : ReportSettings
        What was asked for.
    models : dict
        Name -> model, in the order of the tables.
    notes : tuple of str
        What keeps the figures from being compared with others; a whole evaluation of today's code has none.
    p0, p2 : CleanReport, optional
        Known and unseen responses.
    p1 : dict, optional
        Name of a model -> its photographs of another kind of scene.
    p3 : StressReport, optional
        Stress.
    p4 : dict, optional
        Name of a set of real photographs -> its report.
    p5 : dict, optional
        "E_est" or "shape" -> name of a protocol or of a set of real photographs -> name of a model, or of a way of
        asking it -> reliability of what it expected this error to be.
    p6 : dict, optional
        Name of a model -> how many pictures it accepts that no response explains.
    """

    settings: ReportSettings
    models: dict[str, MeasuredModel]
    notes: tuple[str, ...] = ()
    p0: CleanReport | None = None
    p1: dict[str, OtherKindReport] | None = None
    p2: CleanReport | None = None
    p3: StressReport | None = None
    p4: dict[str, RealReport] | None = None
    p5: dict[str, dict[str, dict[str, Reliability]]] | None = None
    p6: dict[str, UnusualReport] | None = None
