"""The result: a response, its evidence and how far to trust it; and the same as a document.

docs/estimate.schema.json describes the document. `crfnet estimate` writes it too, with the names of its files.
"""

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from crfnet_core.errors import EstimateError, Notice
from crfnet_core.photograph.metadata import FileOrigin
from crfnet_core.photograph.recognition import Recognition
from crfnet_core.posterior import Family, LikelyKind, Verdict
from crfnet_core.response.curve import SAMPLES, ResponseCurve
from crfnet_core.response.emor import COMPONENTS
from crfnet_core.response.metrics import brightness_percent
from crfnet_core.statistics.windows import Window
from crfnet_core.types import EqualByFields, Float64Array, is_number, number_of, plain_values, typed_value

#: The version of the document. Entries may be added to it; if one changes its meaning or goes, the version rises.
SCHEMA_VERSION = 1

MOST_FIGURE = 1000  # the largest uncertainty in a document: far more than any response has


@dataclass(frozen=True, eq=False)
class WindowEstimate(EqualByFields):
    """One window's part in an estimate."""

    photo: int  # which of the photographs the window was cut from
    window: Window  # its place, and how much of the range it covers
    weights: Float64Array  # (11,): the EMoR weights that follow from this window alone
    expected_error: float  # the E_est that is expected of them
    #: Whether the window agrees with the photograph's others (`pooling.agreeing`). Without learned pooling, only such
    #: windows count.
    kept: bool


@dataclass(frozen=True)
class CameraAnswer:
    """A stored camera whose measured response is the answer, or could be."""

    name: str  # the camera's, in the library
    basis: str  # the measurement that its response rests on, in words


@dataclass(frozen=True, eq=False)
class ResponseEstimate(EqualByFields):
    """A response, its evidence, and how far to trust it.

    Parameters
    ----------
    curve : ResponseCurve
        The estimated response.
    weights : ndarray, float64, shape (11,)
        The EMoR weights nearest to it.
    windows : tuple of WindowEstimate
        The estimate of each window alone.
    uncertainty : float
        The expected E_est of this estimate.
    shape_uncertainty : float
        Its expected shape error, in stops: see `crfnet_core.response.metrics.shape_error`.
    band : ndarray, float64, shape (2, 1024)
        Lower and upper end of the 90 % credible band around the response.
    families : dict
        Family -> the probability that the response is of this family; their sum is 1.
    verdict : Verdict
        All this in one word.
    prior : str
        Name of the prior.
    origins : tuple of FileOrigin
        How each photograph was made, by its metadata; empty if metadata is ignored.
    warnings : tuple of Notice
        Reasons to expect a poor estimate.
    model : str
        Name and hash of the network.
    photos : tuple of str
        File names of the photographs.
    recognition : Recognition, optional
        The kind of the photographs, if they are not ordinary ones: see `crfnet_core.photograph.recognition`.
    camera : CameraAnswer, optional
        The stored camera whose response this is; None if it is estimated from the photographs alone.
    """

    curve: ResponseCurve
    weights: Float64Array
    windows: tuple[WindowEstimate, ...]
    uncertainty: float
    shape_uncertainty: float
    band: Float64Array
    families: Mapping[Family, float]
    verdict: Verdict
    prior: str
    origins: tuple[FileOrigin, ...]
    warnings: tuple[Notice, ...]
    model: str
    photos: tuple[str, ...]
    recognition: Recognition | None = None
    camera: CameraAnswer | None = None

    @property
    def likely_kind(self) -> LikelyKind | None:
        """The most probable kind of response; None if no families are known."""
        return LikelyKind.from_probabilities(self.families)

    def to_dict(self) -> dict[str, Any]:
        """Return the estimate as a document of plain lists, texts and numbers, ready for `json.dumps`.

        Numbers are in full precision, so that `from_dict` makes an equal estimate of it.
        """
        kind = self.likely_kind
        document = {
            "schema_version": SCHEMA_VERSION,
            "photographs": [{"name": name} for name in self.photos],
            "verdict": self.verdict,
            "uncertainty": self.uncertainty,
            "uncertainty_percent": brightness_percent(self.uncertainty),
            "shape_uncertainty_stops": self.shape_uncertainty,
            "family": {"words": kind.words, "probability": kind.probability} if kind else None,
            "families": self.families,
            "recognition": dataclasses.asdict(self.recognition) if self.recognition else None,
            "camera": dataclasses.asdict(self.camera) if self.camera else None,
            "prior": self.prior,
            "metadata": [dataclasses.asdict(origin) for origin in self.origins],
            "warnings": list(map(str, self.warnings)),
            "model": self.model,
            "weights": self.weights,
            "windows": [_window_document(window) for window in self.windows],
            "response": {"brightness": self.curve.brightness, "lower": self.band[0], "upper": self.band[1]},
        }
        return {name: plain_values(entry) for name, entry in document.items()}

    @classmethod
    def from_dict(cls, document: Mapping[str, Any]) -> Self:
        """Return the estimate in a document that `to_dict` made, or that `crfnet estimate` wrote.

        Entries that this version does not know are left out.

        Raises
        ------
        EstimateError
            If it is another document, or one of a later version.
        CurveError
            If its response does not increase strictly from 0 to 1.
        """
        _check_version(document)
        try:
            response, families = document["response"], typed_value(document["families"], dict)
            shares = [number_of(share, least=0, most=1) for share in families.values()]
            photos = tuple(typed_value(photo["name"], str) for photo in typed_value(document["photographs"], list))
            windows = tuple(map(_window, typed_value(document["windows"], list)))
            if (shares and abs(sum(shares) - 1) > 0.01) or any(window.photo >= len(photos) for window in windows):
                raise ValueError("the shares of the kinds, or the photographs of the windows, are not all there")
            band = np.array([_row(response[end], SAMPLES, least=0, most=1) for end in ("lower", "upper")])
            if (band[0] > band[1]).any():
                raise ValueError("the band ends below its beginning")
            return cls(
                curve=ResponseCurve(_row(response["brightness"], SAMPLES, least=0, most=1)),
                weights=_row(document["weights"], COMPONENTS),
                windows=windows,
                uncertainty=_number(document["uncertainty"]),
                shape_uncertainty=_number(document["shape_uncertainty_stops"]),
                band=band,
                families=dict(zip(map(Family, families), shares, strict=True)),
                verdict=Verdict(document["verdict"]),
                prior=typed_value(document["prior"], str),
                origins=typed_value(document["metadata"], tuple[FileOrigin, ...]),
                warnings=tuple(map(Notice.from_text, typed_value(document["warnings"], tuple[str, ...]))),
                model=typed_value(document["model"], str),
                photos=photos,
                recognition=typed_value(document.get("recognition"), Recognition | None),
                camera=typed_value(document.get("camera"), CameraAnswer | None),
            )
        except KeyError as problem:
            raise EstimateError("estimate_lacks", entry=problem) from None
        except (AttributeError, IndexError, OverflowError, TypeError, ValueError) as problem:
            raise EstimateError("damaged_estimate", problem=problem) from None


def _check_version(document: Mapping[str, Any]) -> None:
    """Refuse a document of another kind or another version."""
    if isinstance(document, Mapping) and "estimates" in document:
        raise EstimateError("list_of_estimates")
    version = document.get("schema_version") if isinstance(document, Mapping) else None
    if version is None:
        raise EstimateError("not_an_estimate")
    if not is_number(version, int, least=SCHEMA_VERSION, most=SCHEMA_VERSION):
        raise EstimateError("other_schema", found=f"{version!a:.20}", known=SCHEMA_VERSION)


def _window_document(estimate: WindowEstimate) -> dict[str, Any]:
    """Return a window's place and its estimate, ready for JSON."""
    window = estimate.window
    return {
        "photo": estimate.photo,
        **dataclasses.asdict(window),
        "extent": window.extent,
        "weights": estimate.weights,
        "expected_error": estimate.expected_error,
        "kept": estimate.kept,
    }


def _window(entry: Mapping[str, Any]) -> WindowEstimate:
    """Return the estimate of a window in a document."""
    photo, window, kept = typed_value(entry["photo"], int), typed_value(entry, Window), typed_value(entry["kept"], bool)
    return WindowEstimate(photo, window, _row(entry["weights"], COMPONENTS), _number(entry["expected_error"]), kept)


def _row(entry: object, length: int, **bounds: float) -> Float64Array:
    """Return the numbers of a document in a row; raise ValueError for another length."""
    row = [number_of(value, **bounds) for value in typed_value(entry, list)]
    if len(row) != length:
        raise ValueError(f"{len(row)} numbers instead of {length}")
    return np.array(row)


def _number(entry: object) -> float:
    """Return a figure of a document, from 0 to `MOST_FIGURE`; NaN for null."""
    return math.nan if entry is None else number_of(entry, least=0, most=MOST_FIGURE)
