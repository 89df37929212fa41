"""A plate's color space, and pixels through OpenColorIO."""

from pathlib import Path

import numpy as np
import PyOpenColorIO as OCIO
from numpy.typing import ArrayLike, NDArray

from crfnet.configs.plate_color_space import PlateColorSpace
from crfnet.luts.lut1d import inverse_response_lut
from crfnet_core.response.curve import ResponseCurve

#: A plate's color space, and a LUT for it that goes beyond [0, 1].
SPACE = PlateColorSpace("CRF plate01", "plate01.spi1d", aliases=("crf_plate01",), description="from a.jpg")
LUT = inverse_response_lut(ResponseCurve.gamma(2.2), length=5101, domain=(-0.125, 1.125))

#: Linear Rec.709 to ACEScg, as published by color-science and others.
REC709_TO_AP1 = np.array(
    [[0.6130974, 0.3395231, 0.0473795], [0.0701937, 0.9163539, 0.0134524], [0.0206156, 0.1095698, 0.8698147]]
)


def converted(config: OCIO.Config, source: str, target: str, pixels: ArrayLike) -> NDArray[np.float32]:
    """Return pixels, shape (N, 3), converted by OpenColorIO's CPU processor."""
    pixels = np.array(pixels, dtype=np.float32)
    processor = config.getProcessor(source, target)
    processor.getOptimizedCPUProcessor(OCIO.OPTIMIZATION_LOSSLESS).applyRGB(pixels)
    return pixels


def through_lut(
    path: Path,
    pixels: ArrayLike,
    direction: OCIO.TransformDirection = OCIO.TRANSFORM_DIR_FORWARD,
    optimization: OCIO.OptimizationFlags = OCIO.OPTIMIZATION_LOSSLESS,
) -> NDArray[np.float32]:
    """Return pixels, shape (..., 3), or gray ones of another shape, through the LUT of a file, which is read anew."""
    OCIO.ClearAllCaches()
    gray = np.array(pixels, dtype=np.float32)
    values = gray if gray.shape[-1:] == (3,) else np.repeat(gray[..., None], 3, axis=-1)
    processor = OCIO.Config.CreateRaw().getProcessor(OCIO.FileTransform(src=str(path), direction=direction))
    processor.getOptimizedCPUProcessor(optimization).applyRGB(values)
    return values if values is gray else values[..., 0]


def loaded(path: Path) -> OCIO.Config:
    """Return the config in a file, and read LUTs anew."""
    OCIO.ClearAllCaches()
    return OCIO.Config.CreateFromFile(str(path))


def rule_names(config: OCIO.Config) -> list[str]:
    """Return the names of the file rules, the first one first."""
    rules = config.getFileRules()
    return [rules.getName(index) for index in range(rules.getNumEntries())]
