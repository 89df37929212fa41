"""Draw docs/picture.png, the picture in the README: ``python docs/make_picture.py`` (needs the extra `plot`).

Above: the estimated response of the bundled photograph with its 90 % band, the true response, and gamma 2.2. Below,
on crops of that photograph: two stops less light, and a defocus. Each is done on the code values as they are, after
gamma 2.2, after the estimated response, and after the true one. Both work on light, so they are right only on linear
values. Every result is encoded again by the curve that linearized it.
"""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

import crfnet
from crfnet import Photo, ResponseCurve, ResponseEstimate
from crfnet_core.types import Float32Array, Float64Array

ROOT = Path(__file__).resolve().parents[1]
PHOTO, TRUE_RESPONSE = ROOT / "tests" / "data" / "plate.jpg", ROOT / "tests" / "data" / "plate_response.csv"
PICTURE = ROOT / "docs" / "picture.png"

#: Size in inches at `DPI`: 1204 x 1058 pixels.
SIZE, DPI = (14.0, 12.3), 86

#: Factor on the light: two stops less.
DARKENING = 0.25

#: The defocus: radius of its disk in pixels of the photograph.
RADIUS = 7.0

#: A part of the photograph: left, top, right, bottom in pixels.
Crop = tuple[int, int, int, int]

#: What is shown of each operation.
DARKENED_CROP: Crop = (300, 20, 500, 170)
DEFOCUSED_CROP: Crop = (388, 54, 500, 138)

INK, QUIET, GRID = "#1b1f24", "#6a737d", "#e6e8eb"
ESTIMATE, TRUE, GAMMA = "#0b66c3", "#1a7f37", "#b42318"

STYLE: dict[Any, Any] = {"font.family": "DejaVu Sans", "font.size": 11, "text.color": INK, "axes.labelcolor": INK}


def draw_picture(path: Path) -> None:
    """Write the picture as PNG."""
    photo = crfnet.read_photo(PHOTO)
    estimate = crfnet.estimate(photo)
    true = ResponseCurve.from_samples(np.loadtxt(TRUE_RESPONSE, delimiter=",", skiprows=1)[:, 1])
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(STYLE)
        figure = Figure(figsize=SIZE, dpi=DPI, facecolor="white")
        FigureCanvasAgg(figure)
        _draw_curves(figure.add_axes((0.05, 0.6, 0.37, 0.365)), estimate, true)
        _draw_photograph(figure.add_axes((0.45, 0.6, 0.54, 0.365), anchor="NE"), photo)
        curves = _linearizations(estimate.curve, true)
        _draw_row(figure, 0.29, "Two stops less light", photo, curves, darkened, DARKENED_CROP)
        _draw_row(figure, 0.01, "The same defocus", photo, curves, defocused, DEFOCUSED_CROP)
        figure.savefig(path, format="png", metadata={"Software": None}, pil_kwargs={"optimize": True})


class Linearization(NamedTuple):
    """A way to make the plate linear: its title, its color in the picture, and its response."""

    title: str
    color: str
    curve: ResponseCurve


def _linearizations(estimated: ResponseCurve, true: ResponseCurve) -> tuple[Linearization, ...]:
    """Return the four ways to make the plate linear; the first leaves it as it is."""
    return (
        Linearization("plate as it is", INK, ResponseCurve.from_samples([0.0, 1.0])),
        Linearization("after gamma 2.2", GAMMA, ResponseCurve.gamma()),
        Linearization("after our estimate", ESTIMATE, estimated),
        Linearization("the truth (true response)", TRUE, true),
    )


def darkened(pixels: Float32Array, curve: ResponseCurve) -> Float64Array:
    """Return code values (H, W, 3) after `DARKENING` of the light that `curve` makes of them, encoded again."""
    return curve.forward(DARKENING * curve.inverse(pixels))


def defocused(pixels: Float32Array, curve: ResponseCurve) -> Float64Array:
    """Return code values (H, W, 3) after a defocus in the light that `curve` makes of them, encoded again."""
    return curve.forward(disk_blurred(curve.inverse(pixels), RADIUS))


def disk_blurred(light: Float64Array, radius: float) -> Float64Array:
    """Return `light`, shape (H, W, 3), averaged over a disk with a soft rim of one pixel; edges are repeated."""
    reach = int(np.ceil(radius))
    offsets = np.arange(-reach, reach + 1)
    disk = np.clip(radius + 0.5 - np.hypot(*np.meshgrid(offsets, offsets)), 0, 1)
    height, width = light.shape[:2]
    padded = np.pad(light, ((reach, reach), (reach, reach), (0, 0)), mode="edge")
    total = np.zeros_like(light)
    for y, x in zip(*np.nonzero(disk), strict=True):
        total += disk[y, x] * padded[y : y + height, x : x + width]
    blurred: Float64Array = total / disk.sum()
    return blurred


def _draw_curves(axes: Axes, estimate: ResponseEstimate, true: ResponseCurve) -> None:
    """Draw the estimate with its band, the true response and gamma 2.2."""
    irradiance = np.linspace(0, 1, len(true.brightness))
    axes.fill_between(irradiance, *estimate.band, color=ESTIMATE, alpha=0.15, linewidth=0, label="its 90 % band")
    lines: tuple[tuple[str, ResponseCurve, dict[str, Any]], ...] = (
        ("our estimate", estimate.curve, {"color": ESTIMATE, "linewidth": 3}),
        ("true response", true, {"color": TRUE, "linewidth": 2.4, "dashes": (1.2, 1.2)}),
        ("gamma 2.2", ResponseCurve.gamma(), {"color": GAMMA, "linewidth": 2, "dashes": (5, 3)}),
    )
    for label, curve, style in lines:
        axes.plot(irradiance, curve.brightness, label=label, **style)
    axes.set(xlim=(0, 1), ylim=(0, 1), xlabel="light on the sensor", ylabel="brightness in the file")
    axes.set_title("The camera's response", loc="left", size=15, weight="bold", pad=12)
    axes.grid(color=GRID)
    axes.set_axisbelow(True)
    axes.tick_params(length=0, colors=QUIET)
    axes.spines[["top", "right"]].set_visible(False)
    handles, labels = axes.get_legend_handles_labels()
    order = [1, 0, 2, 3]
    axes.legend([handles[i] for i in order], [labels[i] for i in order], loc="lower right", frameon=False)


def _draw_photograph(axes: Axes, photo: Photo) -> None:
    """Show the whole photograph with the outlines of the crops."""
    axes.imshow(photo.pixels, interpolation="bicubic")
    for left, top, right, bottom in (DARKENED_CROP, DEFOCUSED_CROP):
        axes.add_patch(Rectangle((left, top), right - left, bottom - top, fill=False, edgecolor="white", linewidth=2))
    axes.set_title("estimated from this one photograph", loc="left", size=15, weight="bold", pad=12)
    axes.set_axis_off()


def _draw_row(
    figure: Figure,
    bottom: float,
    heading: str,
    photo: Photo,
    curves: Sequence[Linearization],
    operation: Callable[[Float32Array, ResponseCurve], Float64Array],
    crop: Crop,
) -> None:
    """Show a crop of an operation in each of the linearizations, the last of which is the truth."""
    width, height = 0.239, 0.75 * 0.239 * SIZE[0] / SIZE[1]
    figure.text(0.01, bottom + height + 0.042, heading, size=15, weight="bold")
    truth = operation(photo.pixels, curves[-1].curve)
    for column, way in enumerate(curves):
        axes = figure.add_axes((0.01 + 0.247 * column, bottom, width, height))
        _draw_crop(axes, operation(photo.pixels, way.curve), truth, way, crop)


def _draw_crop(axes: Axes, pixels: Float64Array, truth: Float64Array, way: Linearization, crop: Crop) -> None:
    """Show the crop of a result under its title, with its RMS difference from the truth in 8-bit codes."""
    left, top, right, bottom = crop
    shown, reference = (image[top:bottom, left:right] for image in (pixels, truth))
    off = 255 * np.sqrt(np.mean((shown - reference) ** 2))
    axes.imshow(np.clip(shown, 0, 1), interpolation="bicubic")
    axes.set_title(way.title, loc="left", size=13, color=way.color, weight="bold")
    if off > 0:
        axes.set_title(f"off by {off:.0f} of 255", loc="right", size=11, color=QUIET)
    axes.set_axis_off()


if __name__ == "__main__":
    draw_picture(Path(sys.argv[1]) if len(sys.argv) > 1 else PICTURE)
