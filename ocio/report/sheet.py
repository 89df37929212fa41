"""The sheet, one picture of an estimate: the curve with its band, the windows, and the plate before and after."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.text import Annotation

from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.files import atomic_write
from crfnet_core.posterior import Verdict
from crfnet_core.response.curve import UNIFORM, ResponseCurve
from crfnet_core.response.transfer_functions import srgb_encode
from crfnet_core.types import Float32Array

from ..errors import PlateError
from .facts import agreeing, basis, expected_errors

#: Size of the sheet in inches at `DPI`: 1800 x 1080 pixels.
SIZE, DPI = (12.0, 7.2), 150

#: Lower edge and height of everything below the heading, as fractions of the height of the sheet.
BOTTOM, HEIGHT = 0.1, 0.72

INK, QUIET, GRID, CURVE = "#1b1f24", "#6a737d", "#e6e8eb", "#0b66c3"
VERDICT_INK = {Verdict.USABLE: "#1a7f37", Verdict.DO_NOT_TRUST: "#b42318"}
WARNING_INK = "#9a6700"

#: Characters of a file name, and of a line across the whole sheet, for which there is room.
LONGEST_NAME, LONGEST_LINE = 46, 165

#: Between the parts of a line.
DOT = "   ·   "

STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.linewidth": 0.8,
    **dict.fromkeys(("axes.edgecolor", "xtick.color", "ytick.color"), QUIET),
    **dict.fromkeys(("axes.labelcolor", "text.color"), INK),
    "text.parse_math": False,
}


def draw_sheet(path: Path, preview: Float32Array, estimate: ResponseEstimate, *, stride: int = 1) -> None:
    """Write the picture of an estimate as PNG; of a stored camera's response, without windows and model.

    `preview`, shape (h, w, 3), is every `stride`-th pixel of the first photograph, code values in [0, 1]. The
    same input gives the same bytes. Raise PlateError if the file is there already or cannot be written.
    """
    if estimate.camera:
        estimate = replace(estimate, model="", windows=())
    with sheet_figure(path) as figure:
        _draw_heading(figure, estimate)
        _draw_curve(figure.add_axes((0.058, BOTTOM, HEIGHT * SIZE[1] / SIZE[0], HEIGHT)), estimate)
        before, after = _picture_axes(figure, side_by_side=preview.shape[0] >= preview.shape[1])
        _draw_photograph(before, preview, estimate, stride)
        linear = srgb_encode(estimate.curve.inverse(preview)).astype(np.float32)
        _show(after, linear, 1, "Linear plate, in an sRGB view")


@contextmanager
def sheet_figure(path: Path) -> Iterator[Figure]:
    """Yield an empty figure in the style of the sheets, and write it as PNG, the same drawing with the same bytes."""
    with mpl.rc_context(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing from font")  # file names may hold any character
        mpl.rcdefaults()
        mpl.rcParams.update(STYLE)
        figure = Figure(figsize=SIZE, dpi=DPI, facecolor="white")
        FigureCanvasAgg(figure)
        yield figure
        with atomic_write(path, error=PlateError) as temporary:
            figure.savefig(temporary, format="png", metadata={"Software": None}, pil_kwargs={"compress_level": 4})


def _draw_heading(figure: Figure, estimate: ResponseEstimate) -> None:
    """Draw the photograph's name, the verdict with the expected errors, what it rests on, and the warnings."""
    name = ellipsized(estimate.photos[0], LONGEST_NAME)
    more = f" + {len(estimate.photos) - 1}" if len(estimate.photos) > 1 else ""
    figure.text(0.058, 0.945, f"Camera response of {name}{more}", size=15, weight="bold", va="center")
    color = VERDICT_INK[estimate.verdict]
    verdict = figure.text(0.058, 0.9, estimate.verdict, size=11, weight="bold", va="center", color=color)
    result = DOT.join(map(str, filter(None, [f"expected error {expected_errors(estimate)}", estimate.likely_kind])))
    place: dict[str, Any] = {"xytext": (12, 0), "textcoords": "offset points", "va": "center"}
    figure.add_artist(Annotation(result, xy=(1, 0.5), xycoords=verdict, color=INK, **place))
    figure.text(0.058, 0.872, ellipsized(basis(estimate), LONGEST_LINE), va="center", color=QUIET)
    figure.text(0.972, 0.058, estimate.model, va="center", ha="right", color=QUIET)
    warning_line = ellipsized(DOT.join(map(str, estimate.warnings)), LONGEST_LINE)
    figure.text(0.058, 0.026, warning_line, va="center", color=WARNING_INK)


def _draw_curve(axes: Axes, estimate: ResponseEstimate) -> None:
    """Draw the response with its band, and gamma 2.2."""
    lower, upper = estimate.band
    axes.plot(UNIFORM, estimate.curve.brightness, color=CURVE, linewidth=2.2, label="estimate")
    axes.fill_between(UNIFORM, lower, upper, color=CURVE, alpha=0.18, linewidth=0, label="90 % credible band")
    complete_curve(axes)


def complete_curve(axes: Axes) -> None:
    """Add gamma 2.2, below the other lines, and the scales and the legend to the drawing of a response."""
    gamma = ResponseCurve.gamma().brightness
    axes.plot(UNIFORM, gamma, color=QUIET, linewidth=1.2, dashes=(5, 3), zorder=1.5, label="gamma 2.2")
    axes.set(xlim=(0, 1), ylim=(0, 1), aspect="equal")
    axes.set(xlabel="Irradiance (scene-linear, white = 1)", ylabel="Brightness")
    axes.legend(loc="lower right", frameon=False, fontsize=10)
    plain(axes)


def _picture_axes(figure: Figure, *, side_by_side: bool) -> tuple[Axes, Axes]:
    """Return the axes of the photograph and of the linear plate: side by side, or one above the other."""
    if side_by_side:
        boxes = [(left, BOTTOM, 0.215, HEIGHT) for left in (0.532, 0.757)]
    else:
        half = HEIGHT / 2 - 0.018
        boxes = [(0.532, bottom, 0.44, half) for bottom in (BOTTOM + HEIGHT - half, BOTTOM)]
    before, after = (figure.add_axes(box, anchor="NE") for box in boxes)
    return before, after


def _draw_photograph(axes: Axes, preview: Float32Array, estimate: ResponseEstimate, stride: int) -> None:
    """Show the first photograph with its windows; those whose estimate is far from the others are dashed."""
    _show(axes, preview, stride, f"{agreeing(estimate)}; others dashed" if estimate.windows else "The photograph")
    for each in estimate.windows:
        if each.photo == 0:
            place = (each.window.x, each.window.y), each.window.extent, each.window.extent
            style: Any = "solid" if each.kept else (0, (2, 2))
            for width, color in ((1.8, "#000000"), (0.9, "#ffffff")):
                axes.add_patch(Rectangle(*place, fill=False, linewidth=width, linestyle=style, edgecolor=color))


def _show(axes: Axes, pixels: Float32Array, stride: int, title: str) -> None:
    """Show pixels in [0, 1]; the coordinates of the axes are the photograph's pixels."""
    height, width = pixels.shape[:2]
    codes = np.rint(255 * np.clip(pixels, 0, 1)).astype(np.uint8)
    axes.imshow(codes, extent=(0, width * stride, height * stride, 0), interpolation="antialiased")
    axes.set_title(title, loc="left", size=9, color=QUIET, pad=5)
    axes.set_axis_off()


def plain(axes: Axes) -> None:
    """Draw a grid, and no frame above and on the right."""
    axes.grid(color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(length=0)
    axes.spines[["top", "right"]].set_visible(False)


def ellipsized(text: str, longest: int) -> str:
    """Return `text`, with its middle replaced by an ellipsis if it has more than `longest` characters."""
    if len(text) <= longest:
        return text
    return f"{text[: longest // 2 - 1]}…{text[-(longest // 2 - 1) :]}"
