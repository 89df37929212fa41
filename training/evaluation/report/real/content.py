"""What a report holds of P4, real photographs, as dataclasses."""

from __future__ import annotations

from dataclasses import dataclass

from training.evaluation.report.errors import EstimatorDifference, EstimatorSummary, Interval, PerError

#: The name in the report of the real photographs of both folders together.
BOTH = "both"

#: Above these an answer is far off: in E_est, as much as gamma 2.2 on DoRF; in stops of shape error, four times as
#: much as the mean of the other bodies.
FAR_OFF, FAR_OFF_STOPS = 3.0, 0.4


#: Group of bodies, by how many photographs of each were given together -> the least number of photographs.
POOLED = {"4 photographs": 4, "2 to 4 photographs": 2}


def ways_of(model: str) -> list[str]:
    """Return the names of the ways in which P4 asks a model.

    They are: with the file's metadata; after its loss; after its loss by someone who knows the kind of camera; without
    any metadata.
    """
    return [model, f"{model}, EXIF lost", f"{model}, EXIF lost, kind told", f"{model}, metadata ignored"]


def pooled_name(way: str) -> str:
    """Return the name of the answers that a way of asking gives for all photographs of a body together."""
    return f"{way}, pooled"


@dataclass(frozen=True)
class BodySummary:
    """Means over bodies, each counted once, of every model and baseline.

    `differences` are those between every two of the models and the mean of the other bodies.
    """

    bodies: int
    photographs: int
    estimators: dict[str, EstimatorSummary]
    differences: tuple[EstimatorDifference, ...]


@dataclass(frozen=True)
class RealFigures:
    """The errors of one estimator on one photograph, or their means over those of one body.

    Parameters
    ----------
    errors : PerError of float
        E_est, E_lin x 1e-2 and the shape error in stops.
    uncertainty : float, optional
        The E_est that a model expected; None for a baseline.
    shape_uncertainty : float, optional
        The shape error in stops that it expected.
    verdict : str
        Its verdicts; empty for a baseline.
    coverage : float, optional
        Fraction, 0 to 1, of the true response inside the model's 90 % band.
    """

    errors: PerError[float]
    uncertainty: float | None = None
    shape_uncertainty: float | None = None
    verdict: str = ""
    coverage: float | None = None


@dataclass(frozen=True)
class RealRow:
    """One real photograph, or all of one body.

    Parameters
    ----------
    name, body, kind : str
        Of the photograph; of the camera.
    grade : str
        How well the response was measured.
    photographs : int
        How many the row stands for.
    estimators : dict
        Name of a model, or of a baseline that is shown beside it -> its figures.
    editing : str
        Whether an editor saved the file, in the words of `Editing`.
    is_scaled : bool
        Whether a photograph of the row was made smaller after the camera.
    caution : str
        Why the photograph does not count in the means; empty where it counts.
    """

    name: str
    body: str
    kind: str
    grade: str
    photographs: int
    estimators: dict[str, RealFigures]
    editing: str
    is_scaled: bool
    caution: str


@dataclass(frozen=True)
class TrustedWrongly:
    """How often a model says "good" or "usable" of an answer that is far off.

    Parameters
    ----------
    photographs : int
        Those with the verdict "good" or "usable".
    estimation, shape, either : int
        How many of these have too large an E_est, too large a shape error, or one of the two.
    """

    photographs: int
    estimation: int
    shape: int
    either: int


@dataclass(frozen=True)
class RealReport:
    """P4 on one folder of real photographs, or on two together.

    Parameters
    ----------
    trusted : BodySummary
        The photographs that count: nothing speaks against their response.
    everything : BodySummary, optional
        All photographs, where there are others.
    kinds : dict
        Kind of body ("phone", "compact", "camera", "unknown") -> the trusted photographs of this kind.
    origins, origins_of_everything : dict
        What happened to the file after the camera -> the photographs of this origin: of the trusted ones, and of all.
    weights, weights_of_everything : dict
        Name of a model -> correlation over bodies of the first EMoR weights, true against estimated: of the trusted
        photographs, and of all.
    trusted_wrongly, trusted_wrongly_of_everything : dict
        Name of a model -> how often it says "good" or "usable" and is far off: of the trusted photographs, and of all.
    bodies : tuple of RealRow
        A row for each body, of its trusted photographs.
    photographs : tuple of RealRow
        A row for each photograph.
    pooled : dict
        How many photographs of a body were given together -> the answers for all of them and for each by itself, over
        the bodies that have so many; those that need caution count too.
    """

    trusted: BodySummary
    everything: BodySummary | None
    kinds: dict[str, BodySummary]
    origins: dict[str, BodySummary]
    origins_of_everything: dict[str, BodySummary]
    weights: dict[str, tuple[Interval, ...]]
    weights_of_everything: dict[str, tuple[Interval, ...]]
    trusted_wrongly: dict[str, TrustedWrongly]
    trusted_wrongly_of_everything: dict[str, TrustedWrongly]
    bodies: tuple[RealRow, ...]
    photographs: tuple[RealRow, ...]
    pooled: dict[str, BodySummary]
