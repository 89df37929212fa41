"""Raw files of known cameras with the JPEGs that they make: a mosaic of linear light, and the same light rendered."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import ExifTags, Image, ImageEnhance, ImageFilter
from scipy.ndimage import gaussian_filter, map_coordinates

from crfnet_core.colorimetry import ADOBE_RGB, REC709, Primaries, conversion_matrix
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.linear_pictures import CAMERAS, XYZ, write_dng


@dataclass(frozen=True, kw_only=True)
class PairOptions:
    """How a pair is taken."""

    camera: str = "one"
    light: tuple[float, float, float] = (1.0, 1.0, 1.0)  # its color
    primaries: Primaries = REC709  # of the JPEG
    brightest: float = 99.5  # percentile of the scene that saturates the sensor
    headroom: float = 0.3  # stops by which the JPEG's white is below saturation
    crop: float = 0.01  # part of the raw picture's width that the JPEG leaves out
    distortion: float = 0.0  # part of its distance from the center by which a correction moves a corner
    vignetting: float = 0.0  # stops that the lens takes from the corners, and the JPEG gives back
    local: float = 0.0  # exponent of the surroundings' light in local tone mapping
    reach: float = 1 / 20  # width of these surroundings, as a part of the picture's
    saturation: float = 1.0  # factor on the colors
    shot_noise: float = 1e-4  # variance at saturation
    read_noise: float = 3e-4  # standard deviation
    quality: int = 88  # of the JPEG, which is 4:2:2
    seed: int = 0


def make_pair(folder: Path, light: NDArray[np.float32], response: ResponseCurve, options: PairOptions, name="shot"):
    """Write NAME.dng and NAME.jpg of linear light (H, W, 3) and return both paths."""
    rng = np.random.default_rng(options.seed)
    light = light / np.percentile(light.max(axis=2), options.brightest)
    seen = light * np.exp2(-options.vignetting * radii(light) ** 2)[..., None]
    noise = rng.standard_normal(light.shape) * np.sqrt(options.shot_noise * seen + options.read_noise**2)
    raw = write_dng(folder / f"{name}.dng", seen + noise, camera=options.camera, light=options.light)
    codes = np.rint(255 * rendered(sensed(seen, options), response, options)).astype(np.uint8)
    jpeg = folder / f"{name}.jpg"
    Image.fromarray(codes).save(jpeg, quality=options.quality, subsampling=1)
    return raw, jpeg


def sensed(seen: NDArray[np.float32], options: PairOptions) -> NDArray[np.float64]:
    """Return the light as the sensor clips it, back in linear Rec.709."""
    to_camera = CAMERAS[options.camera] @ XYZ * options.light
    to_camera /= to_camera.sum(axis=1).max()
    return np.clip(seen @ to_camera.T, 0, 1) @ np.linalg.inv(to_camera).T


def rendered(light: NDArray[np.float64], response: ResponseCurve, options: PairOptions) -> NDArray[np.float64]:
    """Return the brightness of the JPEG: cropped, corrected, in its primaries, mapped locally, with the response."""
    height, width = light.shape[:2]
    light = light * np.exp2(options.vignetting * radii(light) ** 2)[..., None]
    surroundings = np.log2(gaussian_filter(np.maximum(light @ XYZ[1], 1e-4), options.reach * width))
    light = light * np.exp2(-options.local * (surroundings - np.median(surroundings)))[..., None]
    light = light @ conversion_matrix(REC709, options.primaries).T
    gray = light.mean(axis=2, keepdims=True)
    light = np.maximum(gray + options.saturation * (light - gray), 0) * 2.0**options.headroom
    new_height, new_width = (round(side * (1 - options.crop)) for side in (height, width))
    y, x = np.mgrid[:new_height, :new_width]
    y, x = y - (new_height - 1) / 2, x - (new_width - 1) / 2
    radial = 1 + options.distortion * (np.hypot(x, y) / np.hypot(width / 2, height / 2)) ** 2
    at = np.stack([y * radial + (height - 1) / 2, x * radial + (width - 1) / 2])
    moved = np.stack([map_coordinates(light[..., c], at, order=1, mode="nearest") for c in range(3)], axis=-1)
    brightness = response.forward(np.clip(moved, 0, 1))
    return np.clip(brightness + 0.5 * (brightness - gaussian_filter(brightness, (0.8, 0.8, 0))), 0, 1)


def radii(light: NDArray[np.floating]) -> NDArray[np.float64]:
    """Return each pixel's distance from the center, 1 at a corner."""
    height, width = light.shape[:2]
    y, x = np.mgrid[:height, :width]
    return np.hypot(x - (width - 1) / 2, y - (height - 1) / 2) / np.hypot(width / 2, height / 2)


def drawn_options(seed: int, **fixed) -> PairOptions:
    """Return options drawn at random, but for fixed ones."""
    rng = np.random.default_rng(seed)
    drawn = {
        "camera": str(rng.choice(["one", "two"])),
        "light": tuple(np.exp2(rng.uniform(-0.6, 0.6, 3) * (1, 0, 1)).tolist()),
        "primaries": ADOBE_RGB if rng.uniform() < 0.2 else REC709,
        "brightest": float(rng.choice([95, 98, 99.5, 99.9])),
        "headroom": float(rng.choice([0.0, rng.uniform(0, 0.6)])),
        "crop": float(rng.uniform(0, 0.03)),
        "distortion": float(rng.choice([0, rng.uniform(-0.03, 0.03)])),
        "vignetting": float(rng.choice([0, rng.uniform(0, 0.7)])),
        "reach": float(np.exp(rng.uniform(np.log(1 / 40), np.log(1 / 10)))),
        "saturation": float(rng.uniform(1, 1.25)),
        "shot_noise": float(10 ** rng.uniform(-5, -3.5)),
        "seed": seed,
    }
    return PairOptions(**{**drawn, **fixed})


def spoil(kind: str, folder: Path, jpeg: Path, other, light, curve: ResponseCurve, options) -> None:
    """Replace the JPEG of a pair by one that is not of this raw file, or no longer as the camera wrote it."""
    rng = np.random.default_rng(options.seed)
    if kind in ("another scene", "moved"):
        moved = np.roll(light, round(light.shape[1] * rng.uniform(0.03, 0.2)), axis=1)
        _, wrong = make_pair(folder, other if kind == "another scene" else moved, curve, options, "wrong")
        wrong.replace(jpeg)
        return
    image = Image.open(jpeg).convert("RGB")
    if kind == "edited" and rng.uniform() < 0.5:  # by a program that leaves its name
        exif = Image.Exif()
        exif[ExifTags.Base.Software] = "Adobe Photoshop Lightroom Classic 13.0"
        image.save(jpeg, quality=92, exif=exif)
    else:
        edited(kind, image, rng).save(jpeg, quality=92)


def edited(kind: str, image: Image.Image, rng: np.random.Generator) -> Image.Image:
    """Return a picture as a program changes it."""
    part = {"cropped": rng.uniform(0.5, 0.88), "crop of 99 %": 0.99}.get(kind)
    if part:
        return image.crop((0, 0, round(image.width * part), round(image.height * part)))
    if kind == "flipped":
        return image.transpose(Image.Transpose.FLIP_LEFT_RIGHT)
    if kind == "blurred":
        return image.filter(ImageFilter.GaussianBlur(rng.uniform(1, 3)))
    if kind == "saturation":
        return ImageEnhance.Color(image).enhance(1.5)
    codes = np.asarray(image, np.float64)
    if kind == "vignette":
        codes = codes * (1 - rng.uniform(0.2, 0.5) * np.square(radii(codes)))[..., None]
    elif kind == "levels of a channel":
        low, high = rng.uniform(10, 30), rng.uniform(225, 245)
        channel = rng.integers(3)
        codes[..., channel] = (codes[..., channel] - low) / (high - low) * 255
    elif kind == "tone curve":
        codes = codes + rng.choice([-1, 1]) * rng.uniform(8, 20) * np.sin(2 * np.pi * codes / 255)
    else:  # a gradient filter
        codes = codes * np.linspace(rng.uniform(0.4, 0.7), 1.2, image.height)[:, None, None]
    return Image.fromarray(np.clip(codes, 0, 255).astype(np.uint8))
