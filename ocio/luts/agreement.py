"""OpenColorIO has the last word on a LUT file: what it refuses, or reads as another table, is no LUT for its hosts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import PyOpenColorIO as OCIO

from crfnet_core.errors import one_line
from crfnet_core.types import Float64Array

from ..errors import LutError
from .rgb_lut import AnyLut

#: Largest difference of an entry, relative to it, and of an end of the domain, relative to the domain: of float32.
TOLERANCE = 1e-6


def opencolorio_steps(path: Path) -> list[OCIO.Transform]:
    """Return the steps of a LUT file as OpenColorIO reads it.

    Raises
    ------
    LutError
        If OpenColorIO refuses the file.
    """
    OCIO.ClearAllCaches()
    names_alone = OCIO.Context()
    names_alone.setEnvironmentMode(OCIO.ENV_ENVIRONMENT_LOAD_PREDEFINED)  # a $ in a file's name is no variable
    transform = OCIO.FileTransform(src=str(path.absolute()), interpolation=OCIO.INTERP_LINEAR)
    try:
        processor = OCIO.Config.CreateRaw().getProcessor(names_alone, transform, OCIO.TRANSFORM_DIR_FORWARD)
        return list(processor.createGroupTransform())
    except UnicodeError:  # OpenColorIO's message quotes the file, or the name is no text
        raise LutError(f"{path}: OpenColorIO reads no LUT from it; write the LUT again") from None
    except (OCIO.Exception, OCIO.ExceptionMissingFile) as problem:
        said = one_line(problem).rpartition(" failed with: ")[2].replace(str(path.absolute()), path.name)
        raise LutError(f"{path}: OpenColorIO reads no LUT from it ({said}); write the LUT again") from None


def check_agreement(path: Path, lut: AnyLut) -> None:
    """Check that OpenColorIO reads the table and the domain of `lut` in a file.

    Raises
    ------
    LutError
        If it refuses the file, or reads something else.
    """
    steps = opencolorio_steps(path)
    before, table = steps[:-1], steps[-1] if steps else None
    is_plain = (
        isinstance(table, OCIO.Lut1DTransform)
        and not table.getInputHalfDomain()
        and table.getHueAdjust() == OCIO.HUE_NONE
        and table.getLength() == len(lut.values)
    )
    if not (
        is_plain and _is_same_table(table, lut) and np.allclose(_ends(before, lut.domain), [[0], [1]], 0, TOLERANCE)
    ):
        raise LutError(f"{path}: OpenColorIO reads another table or domain in it; write the LUT again")


def _is_same_table(table: OCIO.Lut1DTransform, lut: AnyLut) -> bool:
    """Return whether two tables agree; OpenColorIO keeps the subnormal numbers of some formats."""
    found = np.asarray(table.getData(), dtype=np.float64).reshape(-1, 3)
    expected = np.stack([channel.values for channel in lut.channels], axis=1)
    return np.allclose(found, expected, rtol=TOLERANCE, atol=float(np.finfo(np.float32).tiny))


def _ends(steps: list[OCIO.Transform], domain: tuple[float, float]) -> Float64Array:
    """Return what the steps before the table make of the ends of a domain, shape (2, 3)."""
    pixels = np.repeat(np.array(domain, dtype=np.float32), 3)
    if steps:
        processor = OCIO.Config.CreateRaw().getProcessor(OCIO.GroupTransform(steps))
        processor.getOptimizedCPUProcessor(OCIO.OPTIMIZATION_NONE).applyRGB(pixels)
    return pixels.astype(np.float64).reshape(2, 3)
