# SPDX-License-Identifier: GPL-3.0-or-later
"""Load what needs onnxruntime, OpenImageIO or OpenColorIO at first use, so that the add-on always enables."""

from __future__ import annotations

import importlib
from types import ModuleType

import bpy

from .errors import AddonError


def load(module: str) -> ModuleType:
    """Return one of the add-on's modules that import the estimator, for example ``load("pipeline")``.

    Raises
    ------
    AddonError
        If a library is missing.
    """
    expose = getattr(bpy.utils, "expose_bundled_modules", None)
    if expose is not None:
        expose()  # Blender's own OpenImageIO and OpenColorIO, where Blender is a Python module
    try:
        return importlib.import_module(f".{module}", __package__)
    except ImportError as problem:
        missing = (problem.name or str(problem)).partition(".")[0]
        raise AddonError(
            f"{missing} cannot be loaded: a wheel of the add-on is missing or for another system; install the add-on"
            " again from the zip for this system"
        ) from problem
