# SPDX-License-Identifier: GPL-3.0-or-later
"""Refuse plates whose color space in Blender is logarithmic or linear: they have no response to estimate or to undo.

The estimator judges the metadata of their files: `crfnet_core.photograph.metadata.color_tags`.
"""

import re
from pathlib import Path

from crfnet.configs.sources import find_config
from crfnet.errors import ConfigError

from .errors import AddonError
from .job import Job, Plate

#: OpenColorIO's encodings of logarithmic and linear color spaces; their names, for configs that give no encoding.
_LOG_OR_LINEAR_ENCODINGS = ("log", "scene-linear", "display-linear")
_LOG_OR_LINEAR_NAME = re.compile(r"linear|^lin_|aces|adx\d|\blog|log\w?\d?\b", re.IGNORECASE)


def check_is_encoded(plate: Plate, file: Path, config: str) -> None:
    """Raise AddonError if a plate's color space in a config is logarithmic or linear; `file` is one of its files."""
    # Blender takes every DPX file for linear
    is_guess = file.suffix.lower() == ".dpx" and "linear" in plate.color_space.lower()
    if not is_guess and is_log_or_linear(plate.color_space, _encoding(plate.color_space, config)):
        raise AddonError(
            f"{plate.name}: its color space, {plate.color_space}, is logarithmic or linear, so it has no camera"
            " response: choose its color space in Blender, or tick Estimate Anyway under Advanced"
        )


def is_said_encoded(job: Job) -> bool:
    """Return whether the user has said that the plate of a job holds encoded values; see `holds_encoded_values`."""
    return holds_encoded_values(job.plate, job.config, is_forced=job.estimation.is_forced)


def holds_encoded_values(plate: Plate, config: str, *, is_forced: bool) -> bool:
    """Return whether untagged OpenEXR files are encoded: by a color space that is not linear, or Estimate Anyway."""
    return is_forced or not is_log_or_linear(plate.color_space, _encoding(plate.color_space, config))


def is_log_or_linear(color_space: str, encoding: str = "") -> bool:
    """Return whether a color space is logarithmic or linear: by its encoding in the config, else by its name."""
    if encoding:
        return encoding in _LOG_OR_LINEAR_ENCODINGS
    return bool(_LOG_OR_LINEAR_NAME.search(color_space))


def _encoding(color_space: str, config: str) -> str:
    """Return the encoding of a color space in a config; empty if the config gives none."""
    try:
        space = find_config(config).config.getColorSpace(color_space)
    except ConfigError:
        return ""
    return "" if space is None or space.isData() else space.getEncoding() or ""
