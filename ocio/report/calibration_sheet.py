"""The sheet of a calibration: the measured response, every frame's points, and their residuals."""

from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from crfnet_core.calibration import PairCalibration
from crfnet_core.response.curve import UNIFORM
from crfnet_core.types import Float64Array

from . import sheet
from .calibration import Measured, calibration_lines, white_words

#: Darkest irradiance that is drawn, log2 (white is 0), and largest residual, in 8-bit codes.
DARKEST, LARGEST_RESIDUAL = -12, 8

#: Colors of the channels; causes of residuals -> the column of `points`; the gap between their axes.
CHANNELS = np.array([[0.76, 0.18, 0.16, 0.6], [0.12, 0.52, 0.24, 0.6], [0.1, 0.4, 0.76, 0.6]])
PAIR_CAUSES = {"Radius (corner = 1)": 4, "Saturation": 5, "Surroundings (stops)": 6}
STACK_CAUSES, GAP = {"Irradiance in stops, white = 0": 0}, 0.02


def draw_calibration(path: Path, calibration: Measured) -> None:
    """Write the picture of a calibration as PNG, or raise PlateError; the same input gives the same bytes."""
    with sheet.sheet_figure(path) as figure:
        _draw_heading(figure, path, calibration)
        width = sheet.HEIGHT * sheet.SIZE[1] / sheet.SIZE[0]
        _draw_curve(figure.add_axes((0.058, sheet.BOTTOM, width, sheet.HEIGHT)), calibration)
        upper, lower = 0.42, sheet.HEIGHT - 0.42 - 0.09
        points = figure.add_axes((0.56, sheet.BOTTOM + sheet.HEIGHT - upper, 0.412, upper))
        if isinstance(calibration, PairCalibration):
            colors = CHANNELS[calibration.points[:, 7].astype(int)]
            title, causes = "Cells of every shot, over irradiance in stops", PAIR_CAUSES
        else:
            stops = np.array([frame.stops for frame in calibration.frames])
            place = (stops - stops.min()) / max(float(np.ptp(stops)), 1e-9)
            colors = np.asarray(colormaps["viridis"](0.9 * place))[calibration.points[:, 3].astype(int)]
            title, causes = "Points of every frame, dark to bright, over irradiance in stops", STACK_CAUSES
        _draw_points(points, calibration, colors, title)
        step = (0.412 + GAP) / len(causes)
        for number, (cause, column) in enumerate(causes.items()):
            axes = figure.add_axes((0.56 + number * step, sheet.BOTTOM, step - GAP, lower))
            _draw_residuals(axes, calibration, column, colors, cause)
            axes.set_ylabel("Residual (codes)" if number == 0 else "")
            axes.tick_params(labelleft=number == 0)


def _draw_heading(figure: Figure, path: Path, calibration: Measured) -> None:
    """Draw the camera, both uncertainties, and the warnings."""
    uncertainty = calibration.uncertainty
    name = path.stem.removesuffix("_sheet")
    figure.text(0.058, 0.945, sheet.ellipsized(f"Measured response {name}", 60), size=15, weight="bold", va="center")
    parts = [
        f"shape to {uncertainty.shape_stops:.2f} stop",
        f"scale to {uncertainty.scale_stops:.2f} stop",
        f"residual {calibration.residual:.1f} codes (RMS)",
        white_words(calibration),
    ]
    figure.text(0.058, 0.9, sheet.DOT.join(parts), size=11, va="center", color=sheet.INK)
    lines = calibration_lines(calibration)
    figure.text(0.058, 0.868, sheet.ellipsized(lines[0], sheet.LONGEST_LINE), va="center", color=sheet.QUIET)
    warnings = sheet.ellipsized(sheet.DOT.join(map(str, calibration.warnings)), sheet.LONGEST_LINE)
    figure.text(0.058, 0.026, warnings, va="center", color=sheet.WARNING_INK)


def _draw_curve(axes: Axes, calibration: Measured) -> None:
    """Draw the response and gamma 2.2; of pairs, codes that were not seen are dotted."""
    brightness = calibration.curve.brightness
    low, high = calibration.codes_seen if isinstance(calibration, PairCalibration) else (0, 255)
    seen = np.where((brightness >= low / 255) & (brightness <= high / 255), brightness, np.nan)
    axes.plot(UNIFORM, seen, color=sheet.CURVE, linewidth=2.2, label="measured")
    if (low, high) != (0, 255):
        axes.plot(UNIFORM, brightness, color=sheet.CURVE, linewidth=1.4, linestyle=":", label="not seen")
    sheet.complete_curve(axes)


def _draw_points(axes: Axes, calibration: Measured, colors: Float64Array, title: str) -> None:
    """Draw points over their irradiance in stops, and the curve through them."""
    stops, brightness = calibration.points.T[:2]
    axes.scatter(stops, brightness, s=1.5, c=colors, linewidths=0, rasterized=True)
    dense = np.linspace(DARKEST, 0.5, 600)
    axes.plot(dense, calibration.curve.forward(np.exp2(dense)), color=sheet.INK, linewidth=1)
    axes.set(xlim=(DARKEST, 0.5), ylim=(0, 1.02), ylabel="Brightness")
    axes.set_title(title, loc="left", size=9, color=sheet.QUIET, pad=5)
    sheet.plain(axes)


def _draw_residuals(axes: Axes, calibration: Measured, column: int, colors: Float64Array, title: str) -> None:
    """Draw the residuals over a column of the points; of pairs, also their medians in eight parts of it."""
    cause = calibration.points[:, column]
    residual = np.clip(255 * calibration.points[:, 2], -LARGEST_RESIDUAL, LARGEST_RESIDUAL)
    axes.scatter(cause, residual, s=1.5, c=colors, linewidths=0, rasterized=True)
    if isinstance(calibration, PairCalibration):
        parts = np.array_split(cause.argsort(), 8)
        medians = [[np.median(values[part]) for part in parts] for values in (cause, residual)]
        axes.plot(*medians, color=sheet.INK)
    axes.axhline(0, color=sheet.INK, linewidth=1)
    limits = (DARKEST, 0.5) if column == 0 else None
    axes.set(xlim=limits, ylim=(-LARGEST_RESIDUAL, LARGEST_RESIDUAL), xlabel=title)
    sheet.plain(axes)
