"""Measure a camera's response from raw files and their JPEGs: the whole of it on one screen."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from crfnet_core.calibration.blocks import medians_of_bins
from crfnet_core.calibration.curve_model import CurveModel, in_camera_mean
from crfnet_core.calibration.frames import check_files
from crfnet_core.calibration.measured import CHANNEL_PART, PairCalibration, ShotReport, Uncertainty, WhiteBasis
from crfnet_core.calibration.raw_pairs.cells import WHITE, Cells, find_cells
from crfnet_core.calibration.raw_pairs.files import Pair, find_pairs, read_pair
from crfnet_core.calibration.raw_pairs.fit import PairFit, fit_pairs
from crfnet_core.calibration.robust import rms_codes
from crfnet_core.errors import CalibrationError, Notice
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.emor import EmorBasis
from crfnet_core.response.metrics import FIRST_SHAPE_CODE, LAST_SHAPE_CODE, scale_error, shape_error
from crfnet_core.types import BoolArray, Float64Array, Progress, show_progress

#: Rounds of cells and fit: codes are averaged in the light of the last response.
ROUNDS = 2

#: Cells that a measurement needs, and each of its shots; cells at white that show where it is.
LEAST_CELLS, LEAST_OF_SHOT, LEAST_WHITE = 300, 20, 10

#: Least code that has to be seen, and the ones from which and up to which the shape counts as seen.
LEAST_TOP, SEEN_TOP, SEEN_BOTTOM = 150.0, 235.0, 25.0

#: Parts of the cells' codes that lie below and above the codes that were seen.
SEEN_PARTS = (0.005, 0.998)

#: Exponents of local tone mapping that are refused, and that are worth a notice.
MOST_LOCAL, NOTABLE_LOCAL = 0.1, 0.03

#: Largest gradient in stops over the diagonal: no camera makes one.
MOST_TILT = 0.5

#: Stops between shots, residual in 8-bit codes, and fraction of outliers from which one curve does not explain them.
MOST_APART, MOST_RESIDUAL, MOST_OUTLIERS = 0.15, 4.0, 0.35

#: Stops between raw saturation and white within which they are the same, and the deviation of their distance then.
SAME_WHITE, SAME_WHITE_DEVIATION = 0.12, 0.03

#: The least parts in stops. The shape's is set on simulated pairs, so that the stated deviation holds for nine of ten
#: whose codes 25 to 235 were seen; without it, it holds for seven of ten.
LEAST_SHAPE, LEAST_SCALE = 0.0175, 0.02

#: Width in codes of the bins in which channels are compared, the cells that one needs, and the least slope a stop.
CODE_BIN, LEAST_IN_BIN, LEAST_RISE = 32, 20, 0.01

#: Standard deviation of white in stops: so that the stated one holds for four of five simulated pairs. A response that
#: ends flat reaches white slowly, even where white is seen.
WHITE_DEVIATIONS = {
    WhiteBasis.SEEN: 0.3,
    WhiteBasis.RAW_CLIP: 0.2,
    WhiteBasis.EXTRAPOLATED: 0.45,
    WhiteBasis.BRACKETED: 0.5,
}


def measure_pairs(
    paths: Sequence[Path], *, accept_edited: bool = False, progress: Progress | None = None
) -> PairCalibration:
    """Measure the response of the camera that took raw files and made JPEGs of them, in one picture style.

    `paths` are as `find_pairs` takes them. JPEGs that a program made are refused unless `accept_edited`. `progress` is
    called with (done, total) after every pair that is read.

    Raise PhotoError if a file cannot be read, and CalibrationError if two are not a pair, or no response explains them.
    """
    names = find_pairs(paths)
    pairs = []
    for number, (path, jpeg) in enumerate(names):
        pairs.append(read_pair(path, jpeg, accept_edited=accept_edited))
        show_progress(progress, number + 1, len(names))
    check_files(pairs)
    cells, fit, basis = _measured(pairs)
    curve = fit.response()
    counted = np.isfinite(fit.residual)
    low, high = np.quantile(cells.codes[counted], SEEN_PARTS)
    shots = _shot_reports(pairs, cells, fit)
    _check_fit(fit, shots)
    return PairCalibration(
        curve=curve,
        weights=EmorBasis.load().project(curve.brightness),
        uncertainty=_uncertainty(cells, fit, curve, basis),
        residual=rms_codes(fit.residual),
        metadata=pairs[0].metadata,
        points=_points(cells, fit, counted),
        counts=np.bincount(pairs[0].codes.ravel(), minlength=256).astype(np.float64),
        warnings=_notices(pairs, fit, basis, low),
        white_basis=basis,
        codes_seen=(float(low), float(high)),
        matrix=fit.matrix,
        local=fit.local,
        corner=fit.corner,
        shots=shots,
    )


def _measured(pairs: Sequence[Pair]) -> tuple[Cells, PairFit, WhiteBasis]:
    """Return the cells of pairs, the response and matrix that explain them, and how white is known."""
    curve, fit = in_camera_mean(), None
    saturation = np.median([pair.raw.balance.min() for pair in pairs])  # balanced light of a white surface
    for _ in range(ROUNDS):
        inverse = curve.inverse(np.arange(256) / 255).astype(np.float32)
        cells = Cells.joined([find_cells(pair.raw, pair.codes, pair.place, inverse) for pair in pairs])
        cells = replace(cells, light=cells.light / saturation)
        _check_counts(pairs, (cells.is_open.all(axis=1) & ~cells.is_saturated) @ cells.shot)
        top = float(np.quantile(cells.codes[cells.is_open], SEEN_PARTS[1]))
        if top < LEAST_TOP:
            raise CalibrationError("pair_dark", path=pairs[0].path, top=top, least=LEAST_TOP)
        fit = fit_pairs(cells, fit)
        curve = fit.response()
    assert fit is not None
    basis = _white_basis(cells, fit)
    if basis == WhiteBasis.RAW_CLIP:
        fit = fit_pairs(cells, fit, headroom=(0.0, SAME_WHITE_DEVIATION))
    return cells, fit, basis


def _check_counts(pairs: Sequence[Pair], counts: Float64Array) -> None:
    """Refuse pairs that show too few usable cells, given how many each does, or one of them that shows hardly any."""
    poorest = pairs[int(counts.argmin())]
    for pair, count, least in ((pairs[0], counts.sum(), LEAST_CELLS), (poorest, counts.min(), LEAST_OF_SHOT)):
        if count < least:
            raise CalibrationError("few_cells", path=pair.path, count=int(count), least=least)


def _white_basis(cells: Cells, fit: PairFit) -> WhiteBasis:
    """Return how it is known where white is."""
    neutral = cells.codes.min(axis=1) > SEEN_TOP - 5
    is_seen = cells.is_white.any(axis=1) & neutral & ~cells.is_saturated
    is_clipped = cells.is_saturated & (cells.codes.min(axis=1) >= WHITE - 1)
    top = cells.codes[np.isfinite(fit.residual)].max(initial=0)
    if is_seen.sum() >= LEAST_WHITE and top > SEEN_TOP:
        return WhiteBasis.SEEN
    if is_clipped.sum() >= LEAST_WHITE and top > SEEN_TOP and fit.headroom < SAME_WHITE:
        return WhiteBasis.RAW_CLIP
    return WhiteBasis.EXTRAPOLATED if top > SEEN_TOP else WhiteBasis.BRACKETED


def _uncertainty(cells: Cells, fit: PairFit, curve: ResponseCurve, basis: WhiteBasis) -> Uncertainty:
    """Return how far a response may be off: the posterior, what halves of the pictures say, and white."""
    halves = [fit_pairs(cells.subset(cells.tile == half), fit).response() for half in (0, 1)]
    shape, scale = fit.deviations(np.arange(FIRST_SHAPE_CODE, LAST_SHAPE_CODE + 1) / 255)
    channels, apart = CHANNEL_PART * _between_channels(cells, fit), abs(scale_error(*halves)) / 2
    white, end = WHITE_DEVIATIONS[basis], -math.log2(curve.inverse(1 - 3 / 255)) / 2
    return Uncertainty(
        {"posterior": shape, "sampling": shape_error(*halves) / 2, "channels": channels, "least": LEAST_SHAPE},
        {"posterior": scale, "sampling": apart, "white": white, "end": end, "least": LEAST_SCALE},
    )


def _between_channels(cells: Cells, fit: PairFit) -> float:
    """Return how far the channels' own responses are from the one of all, in stops: of medians over bins of codes."""
    _, slope = CurveModel.load().brightness(fit.weights, fit.log_light)
    counts = np.isfinite(fit.residual) & (cells.codes > FIRST_SHAPE_CODE) & (cells.codes < LAST_SHAPE_CODE)
    off = (fit.residual / np.maximum(slope, LEAST_RISE))[counts]
    groups = (np.floor(cells.codes / CODE_BIN) * 3 + np.arange(3))[counts]
    medians = medians_of_bins(off, groups, LEAST_IN_BIN)
    return float(np.sqrt(np.mean(medians**2))) if len(medians) else 0.0


def _check_fit(fit: PairFit, shots: Sequence[ShotReport]) -> None:
    """Refuse pairs that are mapped locally, or not explained by one response."""
    path = shots[0].path
    if abs(fit.local) > MOST_LOCAL:
        raise CalibrationError("local_tones", path=path, local=fit.local)
    tilts = 2 * np.hypot(*fit.tilts.T)
    if tilts.max() > MOST_TILT:
        tilted = shots[int(tilts.argmax())]
        raise CalibrationError("pair_tilted", path=tilted.jpeg or tilted.path, stops=float(tilts.max()))
    offsets = [shot.offset for shot in shots]
    if np.ptp(offsets) > MOST_APART:
        first, last = shots[int(np.argmin(offsets))].path.name, shots[int(np.argmax(offsets))].path.name
        raise CalibrationError("shots_differ", first=first, last=last, stops=float(np.ptp(offsets)), most=MOST_APART)
    residual = rms_codes(fit.residual)
    if residual > MOST_RESIDUAL or fit.outliers > MOST_OUTLIERS:
        raise CalibrationError("pair_unexplained", path=path, residual=residual, outliers=fit.outliers)


def _notices(pairs: Sequence[Pair], fit: PairFit, basis: WhiteBasis, low: float) -> tuple[Notice, ...]:
    """Return the doubts about a measurement that are not a reason to refuse it."""
    doubts: list[tuple[str, Mapping[str, object], object]] = [
        *(("measures_program", {"editor": pair.editor}, pair.editor) for pair in pairs),
        ("local_fitted", {"local": fit.local}, abs(fit.local) > NOTABLE_LOCAL),
        ("white_extrapolated", {}, basis is WhiteBasis.EXTRAPOLATED),
        ("white_bracketed", {}, basis is WhiteBasis.BRACKETED),
        ("dark_unseen", {"low": low}, low > SEEN_BOTTOM),
    ]
    return tuple(Notice(code, facts) for code, facts, is_so in doubts if is_so)


def _shot_reports(pairs: Sequence[Pair], cells: Cells, fit: PairFit) -> tuple[ShotReport, ...]:
    """Return a report of each pair."""
    return tuple(
        ShotReport(
            path=pair.path,
            jpeg=pair.jpeg,
            iso=pair.raw.iso,
            cells=int(own.sum()),
            offset=float(offset),
            residual=rms_codes(fit.residual[own]),
            correlation=pair.place.correlation,
        )
        for pair, offset, own in zip(pairs, fit.offsets, cells.shot.T == 1, strict=True)
    )


def _points(cells: Cells, fit: PairFit, counted: BoolArray) -> Float64Array:
    """Return `PairCalibration.points`."""
    chroma = np.ptp(cells.codes, axis=1) / np.maximum(cells.codes.max(axis=1), 1)
    per_cell = (cells.shot.argmax(axis=1), np.hypot(*cells.place.T), chroma, cells.surroundings)
    columns = [fit.log_light, cells.codes / 255, fit.residual, *(column[:, None] for column in per_cell), np.arange(3)]
    return np.stack([np.broadcast_to(column, counted.shape)[counted] for column in columns], axis=1)
