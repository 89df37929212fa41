"""What a camera or an editor does to an encoded picture: noise reduction, color, sharpening, JPEG, scaling.

Pictures are three planes, red, green and blue, each float32 (N, S, S) in [0, 1], of N frames.
"""

from dataclasses import dataclass

import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter1d, uniform_filter1d

from crfnet_core.photograph.metadata.jpeg import ANNEX_K_CHROMA, ANNEX_K_LUMA
from crfnet_core.types import Float32Array, Uint8Array
from training.synthesis.camera import jpeg_compressed
from training.synthesis.sensor import Planes

#: Weights of red, green and blue in the luma of JPEG (ITU-R BT.601).
LUMA = (0.299, 0.587, 0.114)

#: The tables of quantization of the JPEG standard (ITU-T T.81, Annex K) for luma and chroma, row by row.
STANDARD_TABLES = tuple(np.array(table, np.float64) for table in (ANNEX_K_LUMA, ANNEX_K_CHROMA))


@dataclass(frozen=True)
class Jpeg:
    """A JPEG compression."""

    scale: float = 0.2  # factor on the standard's tables: 1 is IJG quality 50, 0.2 quality 90, 0.04 quality 98
    flatness: float = 0.0  # in [0, 1]: 0 for the standard's tables; the more, the nearer all steps lie
    subsampling: int = 2  # 0 for chroma at full resolution (4:4:4), 1 at half along rows (4:2:2), 2 at half along both

    @property
    def tables(self) -> list[list[int]]:
        """The two tables of quantization, 64 integers each, row by row."""
        bent = [table[0] * (table / table[0]) ** (1 - self.flatness) for table in STANDARD_TABLES]
        return [np.clip(np.rint(table * self.scale), 1, 255).astype(int).tolist() for table in bent]

    def compressed(self, codes: Uint8Array) -> Uint8Array:
        """Return frames, uint8 (N, H, W, 3), as they come back from the file."""
        return jpeg_compressed(codes, qtables=self.tables, subsampling=self.subsampling)


@dataclass(frozen=True)
class Sharpening:
    """An unsharp mask on luma, with halos."""

    amount: float  # factor on the difference between the luma and its blurred copy, which is added
    radius: float = 1.0  # standard deviation, in samples, of the Gaussian that blurs
    limit: float = 1.0  # the most that is added or taken away, in [0, 1]
    threshold: float = 0.0  # differences are made smaller by this first, so that noise is not sharpened

    def added(self, luma: Float32Array) -> Float32Array:
        """Return the values that the mask adds to luma, float32 (N, S, S)."""
        detail = luma - gaussian(luma, self.radius)
        if self.threshold:
            detail -= np.clip(detail, -self.threshold, self.threshold)
        return np.clip(detail * np.float32(self.amount), -self.limit, self.limit)


@dataclass(frozen=True)
class Finish:
    """The steps on the encoded picture before JPEG, in this order; the defaults leave every step out."""

    chroma_blur: int = 0  # chroma noise reduction: side, in samples, of the two boxes that blur chroma, rounded to odd
    #: Luma noise reduction: the standard deviation, in [0, 1], below which detail counts as noise.
    luma_smoothing: float = 0.0
    chroma_gain: float = 1.0  # factor on chroma
    sharpening: Sharpening | None = None

    def applied(self, planes: Planes) -> Planes:
        """Return the finished picture, which may leave [0, 1]."""
        if self == Finish():
            return planes
        red, green, blue = planes
        luma = np.float32(LUMA[0]) * red + np.float32(LUMA[1]) * green + np.float32(LUMA[2]) * blue
        chroma = [red - luma, blue - luma]
        if self.chroma_blur > 1:
            chroma = [box_blurred(box_blurred(plane, self.chroma_blur), self.chroma_blur) for plane in chroma]
        if self.luma_smoothing:
            luma = smoothed(luma, self.luma_smoothing)
        if self.chroma_gain != 1:
            chroma = [plane * np.float32(self.chroma_gain) for plane in chroma]
        if self.sharpening is not None:
            luma = luma + self.sharpening.added(luma)
        of_red, of_blue = chroma
        green = luma - np.float32(LUMA[0] / LUMA[1]) * of_red - np.float32(LUMA[2] / LUMA[1]) * of_blue
        return [luma + of_red, green, luma + of_blue]


def smoothed(luma: Float32Array, deviation: float) -> Float32Array:
    """Return luma without detail below `deviation` among 3 x 3 samples, and with its edges: Lee's filter (1980)."""
    mean = box_blurred(luma, 3)
    variance = np.maximum(box_blurred(luma * luma, 3) - mean * mean, 0)
    return mean + variance / (variance + np.float32(deviation**2)) * (luma - mean)


def gaussian(plane: Float32Array, sigma: float) -> Float32Array:
    """Return planes (N, S, S) under a Gaussian of `sigma` samples."""
    return gaussian_filter1d(gaussian_filter1d(plane, sigma, axis=1, truncate=2.5), sigma, axis=2, truncate=2.5)


def box_blurred(plane: Float32Array, size: int) -> Float32Array:
    """Return the means of size x size samples around each of planes (N, S, S)."""
    return uniform_filter1d(uniform_filter1d(plane, size, axis=1), size, axis=2)


def rounded(planes: Planes) -> Uint8Array:
    """Return the codes of planes, clipped and rounded to 8 bits, uint8 (N, S, S, 3)."""
    codes = np.empty((*planes[0].shape, 3), np.uint8)
    for channel, plane in enumerate(planes):
        scaled = plane * np.float32(255)
        scaled += np.float32(0.5)
        codes[..., channel] = np.clip(scaled, 0, 255.9, out=scaled)
    return codes


def split(codes: Uint8Array) -> Planes:
    """Return the planes, float32 (N, S, S) in [0, 1], of codes (N, S, S, 3)."""
    return [codes[..., channel] * np.float32(1 / 255) for channel in range(3)]


def resized(frames: np.ndarray, side: int, resample: Image.Resampling = Image.Resampling.BILINEAR) -> np.ndarray:
    """Return frames, uint8 (N, H, W, 3) or float32 (N, H, W), scaled to side x side samples."""
    return np.stack([np.asarray(Image.fromarray(frame).resize((side, side), resample)) for frame in frames])
