"""Scene-linear pictures from camera raw, OpenEXR and Radiance HDR files, scaled down in linear light."""

from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
import rawpy
from numpy.typing import NDArray

from crfnet_core.errors import PhotoError
from crfnet_core.photograph.camera_raw import libraw_message
from crfnet_core.photograph.image_io import first_line
from crfnet_core.photograph.image_io.file_kinds import LINEAR_SIGNATURES, RAW_SUFFIXES
from crfnet_core.photograph.image_io.header_checks import channel_names, check_size, oiio_message, text_attribute
from crfnet_core.statistics.windows import WINDOW_SIZE
from training.data.scenes import BAND, LUMINANCE, area_averaged

#: The automatic scale leaves the shorter side at least this many samples, room for windows of step 1 and 2.
LEAST_SIDE = 2 * WINDOW_SIZE

#: An HDR file, whose unit is arbitrary, is multiplied by the power of two that brings its median luminance nearest to
#: this; larger values than half floats hold are clipped.
MEDIAN_LUMINANCE, LARGEST = 0.18, 65000.0

#: Options of LibRaw. None depends on the picture, so twice the light is twice the value.
DEVELOPMENT: dict[str, Any] = {
    "gamma": (1, 1),
    "output_bps": 16,
    "output_color": rawpy.ColorSpace.sRGB,  # Rec.709 primaries
    "use_camera_wb": True,
    "no_auto_bright": True,
    "adjust_maximum_thr": 0.0,  # else a picture's own maximum, where it is near the sensor's, is taken for white
    "highlight_mode": rawpy.HighlightMode.Clip,
    "user_flip": 0,
}


def linear_scene(path: Path, *, is_panorama: bool = False) -> tuple[NDArray[np.float16], list[str]]:
    """Return the scene as it will be written, float16 (H, W, 3) in [0, 65000], and notes on what was done to it.

    Each n x n samples become their mean, for the largest n that leaves the shorter side `LEAST_SIDE`. Raise PhotoError
    or OSError if the file is absent, damaged, not scene-linear, too small or black, or no panorama where one is needed.
    """
    with path.open("rb") as file:
        head = file.read(16)
    is_raw = path.suffix.lower() in RAW_SUFFIXES
    if not is_raw and not any(head.startswith(signatures) for signatures in LINEAR_SIGNATURES.values()):
        raise PhotoError(
            f"{path}: is not scene-linear; give camera raw, OpenEXR or Radiance HDR, not a picture developed from it"
        )
    samples = read_raw(path) if is_raw else read_hdr(path)
    band = panorama_band(samples, path) if is_panorama else samples
    side = min(band.shape[:2])
    if side < WINDOW_SIZE:
        raise PhotoError(f"{path}: {side} rows or columns are too few; windows need {WINDOW_SIZE}")
    scale = max(1, side // LEAST_SIDE)
    notes = [f"area-averaged {scale}x{scale} from {samples.shape[1]}x{samples.shape[0]}"] if scale > 1 else []
    if not is_raw:
        fitted, (factor, *more) = _fitted(band, scale, path)
        return fitted, [factor, *notes, *more]
    pixels = np.divide(area_averaged(band, scale), 65535, dtype=np.float32)
    _positive_luminance(pixels, path)
    return pixels.astype(np.float16), ["sensor white = 1", *notes]


def read_raw(path: Path) -> NDArray[np.uint16]:
    """Return a developed camera raw file, uint16 (H, W, 3), linear, Rec.709 primaries, the sensor's white at 65535.

    The white balance is the camera's, the demosaicing AHD. Rows and columns are as stored, whatever the orientation.
    Negative values, which are colors outside the primaries, become 0.
    """
    try:
        with rawpy.imread(str(path)) as raw:
            check_size(path, raw.sizes.width, raw.sizes.height)
            pixels = raw.postprocess(**DEVELOPMENT)
    except rawpy.LibRawError as problem:
        raise PhotoError(f"{path}: LibRaw cannot develop it ({libraw_message(problem)}); check the file") from problem
    return _three_channels(pixels)


def read_hdr(path: Path) -> NDArray[np.float32]:
    """Return the samples of an OpenEXR or Radiance HDR file, float32 (H, W, 3), as stored."""
    source = oiio.ImageInput.open(str(path))
    problem = oiio_message()
    if source is None:
        raise PhotoError(f"{path}: cannot be read ({first_line(problem)}); check the file")
    try:
        header = source.spec()
        _check_header(path, header)
        values = source.read_image(0, 0, 0, header.nchannels, "float")
        problem = oiio_message(source)
    finally:
        source.close()
    if values is None or problem:
        raise PhotoError(f"{path}: is damaged or cut short ({first_line(problem)}); copy it again")
    channels = [header.channelindex(name) for name in "RGB"]
    return values[..., channels] if min(channels) >= 0 else _three_channels(values[..., :1])


def panorama_band(samples: NDArray[Any], path: Path) -> NDArray[Any]:
    """Return the middle `BAND` of the rows of an equirectangular panorama; a PhotoError if it is not 2:1."""
    height, width, _ = samples.shape
    if width != 2 * height:
        raise PhotoError(
            f"{path}: {width} x {height} is not a whole panorama, twice as wide as high; import it as a photograph"
        )
    rows = int(height * (BAND[1] - BAND[0]))
    top = (height - rows) // 2
    return samples[top : top + rows]


def _check_header(path: Path, header: Any) -> None:
    """Refuse an OpenEXR or HDR file that is not a flat scene-linear picture of floats."""
    check_size(path, header.width, header.height)
    names, space = channel_names(header), text_attribute(header, "colorInteropID")
    if header.deep or header.depth != 1 or str(header.format) not in ("half", "float"):
        raise PhotoError(f"{path}: is deep, a volume, or not of half or float samples; convert it")
    if not (set(names) >= set("RGB") or len(set(names) - {"A"}) == 1):
        raise PhotoError(f"{path}: needs channels R, G and B, or a gray one; found {', '.join(names)}")
    if space and space != "unknown" and not space.startswith("lin_"):
        raise PhotoError(f"{path}: calls itself {space}, which is not scene-linear; give the linear file")


def _fitted(samples: NDArray[Any], scale: int, path: Path) -> tuple[NDArray[np.float16], list[str]]:
    """Return an HDR picture averaged, scaled and without negative values, and notes on what was done to it."""
    negative = float((samples < 0).mean())
    pixels = area_averaged(np.maximum(np.nan_to_num(samples, nan=0, posinf=np.inf, neginf=0), 0), scale)
    exponent = round(float(np.log2(MEDIAN_LUMINANCE / np.median(_positive_luminance(pixels, path)))))
    pixels = np.ldexp(pixels, exponent)
    clipped = int((pixels > LARGEST).any(axis=2).sum())
    notes = [f"scale=2^{exponent}"]
    notes += [f"{negative:.2g} negative samples set to 0"] if negative else []
    notes += [f"{clipped} px clipped at {LARGEST:.0f} after scale"] if clipped else []
    return np.minimum(pixels, np.float32(LARGEST)).astype(np.float16), notes


def _positive_luminance(pixels: NDArray[np.float32], path: Path) -> NDArray[np.float32]:
    """Return the luminances of a picture that are positive and finite; refuse one that has none."""
    luminance = (pixels @ LUMINANCE).ravel()
    positive: NDArray[np.float32] = luminance[(luminance > 0) & np.isfinite(luminance)]
    if not positive.size:
        raise PhotoError(f"{path}: is black, or without a finite value; give another photograph")
    return positive


def _three_channels(pixels: NDArray[Any]) -> NDArray[Any]:
    """Return (H, W, 3) from one of (H, W), (H, W, 1) and (H, W, 3)."""
    return np.broadcast_to(pixels.reshape(*pixels.shape[:2], -1), (*pixels.shape[:2], 3))
