"""Draw docs/pictures/exposure.jpg: ``python docs/make_exposure_picture.py`` (needs the extra `plot`).

The bundled photograph in linear light under the ACES 2.0 view of OpenColorIO's studio config, with white at 1, and with
gray at 0.18 (``--exposure gray``). In front of it are three things that reflect 18 % of the light: a gray card as a
camera stores it by convention (code 118 of the photograph), and a card and a sphere that are rendered.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import PyOpenColorIO as OCIO
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import crfnet
from crfnet.defaults import GRAY_BRIGHTNESS, MIDDLE_GRAY
from crfnet.luts.exposure import anchored_exposure
from crfnet_core.types import Float32Array

ROOT = Path(__file__).resolve().parents[1]
PHOTO = ROOT / "tests" / "data" / "plate.jpg"
PICTURE = ROOT / "docs" / "pictures" / "exposure.jpg"

#: The config, the space of linear light, and the display and view.
CONFIG, LINEAR = "studio-config-latest", "Linear Rec.709 (sRGB)"
DISPLAY, VIEW = "sRGB - Display", "ACES 2.0 - SDR 100 nits (Rec.709)"

#: Rows of the photograph that are shown, and the height of the objects, in pixels.
ROWS, SIDE = slice(0, 290), 96

#: Direction to the light (right, down, to the camera), and the part of the light that comes from everywhere.
TO_LIGHT, AMBIENT = np.array([0.3, -0.75, 0.6]), 0.25


def draw_exposure_picture(path: Path) -> None:
    """Write the picture as JPEG."""
    photo = crfnet.read_photo(PHOTO)
    curve = crfnet.estimate(photo).curve
    figure = Figure(figsize=(12, 3.0), dpi=90, facecolor="white")
    FigureCanvasAgg(figure)
    for column, gray in enumerate((None, GRAY_BRIGHTNESS)):
        stops = anchored_exposure(curve, gray=gray)
        plate = np.float32(2**stops) * curve.inverse(with_gray_card(photo.pixels[ROWS])).astype(np.float32)
        axes = figure.add_axes((0.005 + 0.5 * column, 0.0, 0.49, 0.9))
        axes.imshow(displayed(with_rendered_objects(plate)), interpolation="bicubic")
        words = "--exposure white" if gray is None else "--exposure gray"
        axes.set_title(f"{words}: {stops:+.2f} stop", loc="left", size=13, weight="bold")
        for place, name in enumerate(("photographed", "rendered", "rendered")):
            axes.text(left_of(place), ROWS.stop - 4, name, color="white", size=7.5)
        axes.set_axis_off()
    path.parent.mkdir(exist_ok=True)
    figure.savefig(path, format="jpeg", pil_kwargs={"quality": 88, "optimize": True})


def displayed(pixels: Float32Array) -> Float32Array:
    """Return linear pixels (H, W, 3) as the view shows them, in [0, 1]."""
    shown = np.array(pixels, dtype=np.float32, order="C")
    view = OCIO.DisplayViewTransform(src=LINEAR, display=DISPLAY, view=VIEW)
    OCIO.Config.CreateFromBuiltinConfig(CONFIG).getProcessor(view).getDefaultCPUProcessor().applyRGB(shown)
    return np.clip(shown, 0, 1)


def left_of(place: int) -> int:
    """Return the first column of the first, second or third object."""
    return 16 + place * (SIDE + 16)


def with_gray_card(pixels: Float32Array) -> Float32Array:
    """Return code values (H, W, 3) with a gray card as a camera stores it by convention."""
    changed = pixels.copy()
    changed[-SIDE - 16 : -16, left_of(0) : left_of(0) + SIDE] = GRAY_BRIGHTNESS
    return changed


def with_rendered_objects(plate: Float32Array) -> Float32Array:
    """Return a linear plate (H, W, 3) with a card and a sphere of 18 % reflectance, rendered."""
    changed = plate.copy()
    rows = changed[-SIDE - 16 : -16]
    rows[:, left_of(1) : left_of(1) + SIDE] = MIDDLE_GRAY
    down, right = np.mgrid[-1 : 1 : SIDE * 1j, -1 : 1 : SIDE * 1j]
    toward = np.sqrt(np.clip(1 - right**2 - down**2, 0, None))
    facing = np.clip(np.stack([right, down, toward], axis=-1) @ (TO_LIGHT / np.linalg.norm(TO_LIGHT)), 0, None)
    inside = right**2 + down**2 < 1
    rows[:, left_of(2) : left_of(2) + SIDE][inside] = (MIDDLE_GRAY * (AMBIENT + (1 - AMBIENT) * facing))[inside, None]
    return changed


if __name__ == "__main__":
    draw_exposure_picture(PICTURE)
