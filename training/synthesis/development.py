"""A camera that develops: from exposed light to the file, with what real files went through.

In this order: lens, sensor with mosaic, white balance and color matrix (`sensor`), local tone mapping, the response,
noise reduction, chroma and sharpening of the encoded picture, JPEG (`picture`), then scaling with another JPEG, or
point sampling of a frame larger than the window. The label of a photograph is the response, the tone curve alone.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter

from crfnet_core.response.transfer_functions import srgb_encode
from crfnet_core.statistics.windows import WINDOW_SIZE
from crfnet_core.types import Float32Array, Float64Array, Uint8Array
from training.data.scenes import LUMINANCE
from training.synthesis.picture import Finish, Jpeg, gaussian, resized, rounded, split
from training.synthesis.sensor import Planes, Sensor

#: Entries of the tables that the response is looked up in, which are fine enough not to leave gaps between codes.
ENTRIES = 1 << 16

#: Irradiance beyond which a light adds no more glare: the few brightest samples would decide it otherwise.
BRIGHTEST = 4.0

#: Step between the samples of the luminance that local tone mapping is computed from, and irradiance that it keeps.
COARSE_STEP, MIDDLE_GRAY = 8, 0.18


@dataclass(frozen=True)
class ToneMapping:
    """Local tone mapping: a smooth gain, before the response, that evens out the large-scale contrast."""

    strength: float  # part of the large-scale contrast, in stops, that is taken out
    #: Standard deviation, as a fraction of the frame's side, of the Gaussian over the logarithm of the luminance.
    radius: float = 0.08

    def gain(self, planes: Planes) -> Float32Array:
        """Return the gain, float32 (N, S, S)."""
        coarse = sum(
            np.float32(weight) * plane[:, ::COARSE_STEP, ::COARSE_STEP]
            for weight, plane in zip(LUMINANCE, planes, strict=True)
        )
        stops = np.log2(np.maximum(coarse, 1e-4) / MIDDLE_GRAY)
        radius = self.radius * stops.shape[1]
        gains = np.exp2(-self.strength * gaussian_filter(stops, (0, radius, radius))).astype(np.float32)
        return resized(gains, planes[0].shape[1])


@dataclass(frozen=True)
class Export:
    """A picture made smaller after it was encoded, as for the web; `finish` has the steps on the small picture."""

    resample: Image.Resampling
    finish: Finish
    jpeg: Jpeg


@dataclass(frozen=True)
class Development:
    """The steps from the exposed light of a frame to the windows of the file; the defaults leave steps out."""

    lens_blur: float = 0.0  # standard deviation, in samples of the frame, of the Gaussian that blurs the irradiance
    glare: float = 0.0  # part of the frame's mean irradiance that the lens spreads over all of it
    sensor: Sensor = field(default_factory=Sensor)
    tone_mapping: ToneMapping | None = None
    keeps_hue: bool = False  # whether the response applies to the largest and the smallest channel only: see `hue_kept`
    finish: Finish = field(default_factory=Finish)
    jpeg: Jpeg | None = None
    #: Scaling to the size of a window; without it the frame is point-sampled where it is larger.
    export: Export | None = None
    #: Samples of the frame by which point sampling displaces each sample at most, at random: it stands for texture that
    #: the scenes do not resolve.
    scatter: int = 0


def develop(
    irradiance: Float32Array,
    curve: Float64Array,
    development: Development,
    rng: np.random.Generator,
    *,
    windows: int | None = None,
) -> Uint8Array:
    """Return the windows of a photograph, uint8 (windows, 227, 227, 3), from the response, (1024,).

    `irradiance`, float32 (N, S, S, 3), is the exposed light of frames of S >= 227 samples along each side. `windows` is
    a multiple of N, and N by default: a frame that is point-sampled may give several.
    """
    planes = [np.ascontiguousarray(irradiance[..., channel]) for channel in range(3)]
    if development.lens_blur:
        planes = [gaussian(plane, development.lens_blur) for plane in planes]
    if development.glare:
        planes = [plane + development.glare * np.minimum(plane, BRIGHTEST).mean() for plane in planes]
    planes = development.sensor.record(planes, rng)
    if development.tone_mapping is not None:
        gain = development.tone_mapping.gain(planes)
        planes = [plane * gain for plane in planes]
    planes = hue_kept(planes, curve) if development.keeps_hue else [looked_up(plane, curve) for plane in planes]
    finish = replace(development.finish, chroma_gain=0.0) if is_gray(irradiance) else development.finish
    codes = rounded(finish.applied(planes))
    if development.jpeg is not None:
        codes = development.jpeg.compressed(codes)
    if development.export is None:
        return point_sampled(codes, (windows or len(codes)) // len(codes), development.scatter, rng)
    export = development.export
    small = split(resized(codes, WINDOW_SIZE, export.resample))
    return export.jpeg.compressed(rounded(export.finish.applied(small)))


def looked_up(plane: Float32Array, curve: Float64Array) -> Float32Array:
    """Return the values of `curve`, shape (1024,), at a plane that is clipped to [0, 1], float32."""
    position = np.linspace(0, len(curve) - 1, ENTRIES)
    table = np.interp(position, np.arange(len(curve)), curve).astype(np.float32)
    return table.take(_entries(plane))


def hue_kept(planes: Planes, curve: Float64Array) -> Planes:
    """Return planes whose largest and smallest channel have the response, and the middle one its place between them.

    The place is measured in linear light, before and after: the response is a tone curve with sRGB's encoding on top.
    """
    encoding = srgb_encode(np.linspace(0, 1, ENTRIES))
    linear_curve = np.interp(curve, encoding, np.linspace(0, 1, ENTRIES))
    clipped = [np.minimum(plane, 1) for plane in planes]
    largest, smallest = np.maximum.reduce(clipped), np.minimum.reduce(clipped)
    low, high = (looked_up(plane, linear_curve) for plane in (smallest, largest))
    slope = (high - low) / np.maximum(largest - smallest, np.float32(1e-5))
    encoded = encoding.astype(np.float32)
    return [encoded.take(_entries(low + slope * (plane - smallest))) for plane in clipped]


def point_sampled(codes: Uint8Array, each: int, scatter: int, rng: np.random.Generator) -> Uint8Array:
    """Return `each` windows of every frame, uint8 (each * N, 227, 227, 3): every n-th sample, or a random one near it.

    The windows of one frame begin at other samples of it.
    """
    count, side = codes.shape[:2]
    step = side // WINDOW_SIZE
    starts = [((i + i // step) % step, i % step) for i in range(each)]
    first = np.arange(WINDOW_SIZE) * step
    parts = []
    for y, x in starts:
        rows, columns = rng.integers(scatter + 1, size=(2, count, WINDOW_SIZE, WINDOW_SIZE))
        rows = np.minimum(rows + (first + y)[:, None], side - 1)
        columns = np.minimum(columns + first + x, side - 1)
        parts.append(codes[np.arange(count)[:, None, None], rows, columns])
    return np.concatenate(parts)


def is_gray(irradiance: Float32Array) -> bool:
    """Return whether the channels of frames are equal, judged by some of their samples."""
    some = irradiance[:, ::8, ::8]
    return bool((some[..., :1] == some).all())


def _entries(plane: Float32Array) -> np.ndarray:
    """Return the nearest entries of a table for a plane clipped to [0, 1], uint16."""
    position = plane * np.float32(ENTRIES - 1)
    position += np.float32(0.5)
    return np.clip(position, 0, ENTRIES - 1, out=position).astype(np.uint16)
