# SPDX-License-Identifier: GPL-3.0-or-later
"""Import what needs onnxruntime, OpenImageIO or OpenColorIO at first use, so that the add-on can always be enabled."""

from __future__ import annotations

import importlib
from types import ModuleType

import bpy

from .work.errors import AddonError


def load(module: str) -> ModuleType:
    """Return a module that imports the estimator, directly or through others.

    Parameters
    ----------
    module : str
        As for `importlib.import_module`: ``".work.run"`` is the add-on's own, ``"ocio.configs.installed"`` is not.

    Raises
    ------
    AddonError
        If a library cannot be imported; it says which one, and to install the add-on again.
    """
    expose = getattr(bpy.utils, "expose_bundled_modules", None)
    if expose is not None:
        expose()  # where Blender is a Python module, its own OpenImageIO and OpenColorIO are hidden without this
    try:
        return importlib.import_module(module, __package__)
    except ImportError as problem:
        missing = (problem.name or str(problem)).partition(".")[0]
        raise AddonError(
            f"{missing} cannot be loaded: a wheel of the add-on is missing or for another system; install the add-on"
            " again from the zip for this system"
        ) from problem
