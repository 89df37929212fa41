"""Pictures that no camera took: screenshots with a small photograph in them, and flat drawings."""

import string
from functools import cache

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from crfnet_core.statistics.windows import WINDOW_SIZE
from crfnet_core.types import Float32Array
from training.synthesis.unusual.encodings import camera_rendering, codes_of

LETTER_SIZES = (9, 11, 13, 16, 20)  # sizes of letters, in pixels
INSET_SIDES = (0.25, 0.75)  # sides of the photograph in a screenshot, as fractions of the screen's
SHAPES = (6, 24)  # range of the number of shapes in a drawing of a window's size
DRAWN_SIZE = 2 * WINDOW_SIZE  # the side of a window at the size at which drawings are drawn: twice their own

#: Length of a word in letters, and words of a line at most.
WORD, WORDS = (1, 11), 60

Color = tuple[int, ...]  # red, green and blue

#: Pillow's own font of a size, loaded once.
_font = cache(ImageFont.load_default)


def screenshot(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return screenshots: flat panels, gradients, lines of text, and a scaled photograph pasted in."""
    pictures = codes_of(camera_rendering(irradiance, rng))
    is_dark = bool(rng.random() < 0.4)
    return np.stack([_screen(picture, is_dark, rng) for picture in pictures])


def _screen(picture: np.ndarray, is_dark: bool, rng: np.random.Generator) -> Float32Array:
    """Return one screen, float32 (H, W, 3), that shows a picture."""
    height, width = picture.shape[:2]
    paper, ink = _gray(rng, is_dark), _gray(rng, not is_dark)
    image = Image.new("RGB", (width, height), paper)
    draw = ImageDraw.Draw(image)
    for _ in range(rng.integers(1, 4)):
        _panel(image, draw, is_dark, rng)
    size = int(rng.choice(LETTER_SIZES))
    y = float(rng.integers(-size, size))
    while y < height:
        color = ink if rng.random() < 0.85 else _color(rng)
        draw.text((float(rng.integers(-20, 30)), y), _line(width, size, rng), color, font=_font(size))
        y += size * rng.choice([1.3, 1.6, 3.0], p=[0.6, 0.3, 0.1])
    inset = _scaled(picture, rng)
    rows, columns = inset.shape[:2]
    image.paste(Image.fromarray(inset), (int(rng.integers(width - columns + 1)), int(rng.integers(height - rows + 1))))
    return np.asarray(image, np.float32) / np.float32(255)


def _panel(image: Image.Image, draw: ImageDraw.ImageDraw, is_dark: bool, rng: np.random.Generator) -> None:
    """Draw a flat panel with a border, or a gradient between two colors."""
    left, top = int(rng.integers(-20, image.width)), int(rng.integers(-20, image.height))
    width, height = int(rng.integers(30, image.width)), int(rng.integers(12, image.height))
    if rng.random() < 0.5:
        color = _gray(rng, is_dark) if rng.random() < 0.6 else _color(rng)
        draw.rectangle((left, top, left + width, top + height), color, outline=_gray(rng, not is_dark))
        return
    position = np.linspace(0, 1, height)[:, None, None]
    colors = (1 - position) * np.array(_color(rng)) + position * np.array(_color(rng))
    image.paste(Image.fromarray(np.repeat(np.rint(colors).astype(np.uint8), width, axis=1)), (left, top))


def _scaled(picture: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return a part of the picture, averaged down after its encoding by 1, 2 or 3."""
    times = int(rng.integers(1, 4))
    scaled = np.asarray(Image.fromarray(picture).reduce(times))
    rows, columns = (max(8, int(side * rng.uniform(*INSET_SIDES))) for side in picture.shape[:2])
    return scaled[:rows, :columns]


def _line(width: int, size: int, rng: np.random.Generator) -> str:
    """Return random words, about as many as fill a part of the width."""
    letters = np.array(list(string.ascii_lowercase + "eeaatnio" + string.digits[:3] + "ABST"))
    wanted = max(1, int(width / (size * 3.5) * rng.uniform(0.2, 1)))
    words = ("".join(rng.choice(letters, rng.integers(*WORD))) for _ in range(min(wanted, WORDS)))
    return " ".join(words)


def line_art(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return drawings of the size of `irradiance`, which they do not show: flat shapes with outlines, and strokes."""
    colors = [_color(rng) for _ in range(rng.integers(2, 9))]
    is_outlined = bool(rng.random() < 0.6)
    size = irradiance.shape[1:3]
    return np.stack([_drawing(size, colors, is_outlined, rng) for _ in irradiance])


def _drawing(size: tuple[int, int], colors: list[Color], is_outlined: bool, rng: np.random.Generator) -> Float32Array:
    """Return one drawing, float32 (H, W, 3); it is drawn at twice the size, so its edges are mixtures of codes."""
    height, width = 2 * size[0], 2 * size[1]
    image = Image.new("RGB", (width, height), (255, 255, 255) if rng.random() < 0.5 else colors[0])
    draw = ImageDraw.Draw(image)
    count = int(rng.integers(*SHAPES) * max(1.0, height * width / DRAWN_SIZE**2 / 2))
    for _ in range(count):
        color = colors[rng.integers(len(colors))]
        outline = (0, 0, 0) if is_outlined else color
        _draw_shape(draw, rng.uniform(0, 1, 2) * (width, height), color, outline, rng)
    return np.asarray(image.resize(size[::-1], Image.Resampling.BOX), np.float32) / np.float32(255)


def _draw_shape(
    draw: ImageDraw.ImageDraw, center: np.ndarray, color: Color, outline: Color, rng: np.random.Generator
) -> None:
    """Draw an ellipse, a rectangle, a polygon or a stroke around a center."""
    sides = np.exp(rng.uniform(np.log(0.04), np.log(0.5), 2)) * DRAWN_SIZE / 2
    box = (*(center - sides).tolist(), *(center + sides).tolist())
    match rng.integers(4):
        case 0:
            draw.ellipse(box, color, outline, int(rng.integers(2, 7)))
        case 1:
            draw.rectangle(box, color, outline, int(rng.integers(2, 7)))
        case 2:
            angles = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(3, 8)))
            corners = center + sides * np.stack([np.cos(angles), np.sin(angles)], axis=1)
            draw.polygon([tuple(corner) for corner in corners.tolist()], color, outline, int(rng.integers(2, 7)))
        case _:
            path = center + np.cumsum(rng.normal(0, DRAWN_SIZE / 12, (rng.integers(2, 9), 2)), axis=0)
            draw.line([tuple(point) for point in path.tolist()], outline, int(rng.integers(2, 12)), "curve")


def _gray(rng: np.random.Generator, is_dark: bool) -> Color:
    """Return a dark or a light gray, nearly neutral."""
    level = rng.integers(0, 60) if is_dark else rng.integers(215, 256)
    return tuple(np.clip(level + rng.integers(-4, 5, 3), 0, 255).tolist())


def _color(rng: np.random.Generator) -> Color:
    return tuple(rng.integers(0, 256, 3).tolist())
