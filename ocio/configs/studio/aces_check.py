"""A plate's colour space, checked in ACES2065-1: the space that all configs have in common."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import PyOpenColorIO as OCIO

from crfnet_core.colorimetry import REC709, conversion_matrix
from crfnet_core.errors import one_line

from ...errors import ConfigError
from ..files import plate_exposure
from ..reference_space import REC709_TO_AP0
from .looks import Look

#: Differences in ACES2065-1 between a config's processor and the LUT and matrix: absolute up to a value of 1, relative
#: above. The first is worth a note, the second refuses the config. Blender 4.5 goes through rounded matrices: 2.4e-4.
TOLERANCE, MOST_DIFFERENCE = 1e-5, 2e-3

#: The role of ACES2065-1 in a config.
INTERCHANGE = "aces_interchange"

#: Brightnesses of each channel at which the colours are compared.
CHECKED_LEVELS = 17


def check_in_ap0(config: OCIO.Config, folder: Path, looks: Mapping[str, Look]) -> list[str]:
    """Check that plates' colour spaces reach ACES2065-1 as their LUTs and the matrix from Rec.709 do; return notes.

    Parameters
    ----------
    config : PyOpenColorIO.Config
        The config. One without the role `aces_interchange` is not checked.
    folder : Path
        The folder from which it finds its files.
    looks : mapping of str to Look
        The look of each plate's colour space, by the name of the space.

    Raises
    ------
    ConfigError
        If OpenColorIO refuses the config, or differs by more than `MOST_DIFFERENCE`. A difference above `TOLERANCE` is
        a note: the config's own linear Rec.709 is another one than the published.
    """
    if config.getColorSpace(INTERCHANGE) is None:
        return [f"not checked in ACES2065-1: the config has no role {INTERCHANGE}"]
    notes = []
    config = copy.deepcopy(config)
    config.setWorkingDir(str(folder))
    OCIO.ClearAllCaches()
    for name, look in looks.items():
        try:
            error = ap0_error(config, name, look)
        except (OCIO.Exception, OCIO.ExceptionMissingFile) as problem:
            raise ConfigError(f"{name}: cannot be converted to ACES2065-1 ({one_line(problem)})") from problem
        if not error <= MOST_DIFFERENCE:
            message = "the config's linear Rec.709 space or its role aces_interchange is wrong; mend it"
            raise ConfigError(f"{name}: differs by {error:.2g} in ACES2065-1; {message}")
        if error > TOLERANCE:
            notes.append(f"in ACES2065-1 the config's own linear Rec.709 is {error:.1g} away from the published one")
    return list(dict.fromkeys(notes))


def ap0_error(config: OCIO.Config, name: str, look: Look) -> float:
    """Return the largest difference in ACES2065-1 between a plate's colour space and its LUT and matrix."""
    levels = np.linspace(0, 1, CHECKED_LEVELS, dtype=np.float32)
    codes = np.stack(np.meshgrid(levels, levels, levels), axis=-1).reshape(-1, 3)
    gain = 2 ** plate_exposure(config.getColorSpace(name))
    matrix = np.array(REC709_TO_AP0) @ conversion_matrix(look.space.primaries, REC709)
    expected = look.lut.apply(codes).astype(np.float64) * gain @ matrix.T
    found = codes.copy()
    config.getProcessor(name, INTERCHANGE).getOptimizedCPUProcessor(OCIO.OPTIMIZATION_NONE).applyRGB(found)
    return float((np.abs(found - expected) / np.maximum(np.abs(expected), 1)).max())
