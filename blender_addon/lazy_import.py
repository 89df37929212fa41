# SPDX-License-Identifier: GPL-3.0-or-later
"""Import what needs onnxruntime, OpenImageIO or OpenColorIO at first use, so that the add-on can always be enabled."""

import importlib
import importlib.metadata
import importlib.util
import sys
import tomllib
from functools import cache
from pathlib import Path
from types import ModuleType

import bpy

from .work.errors import AddonError

#: Packages that come as wheels with the add-on, and with Blender.
_IN_WHEELS = ("crfnet_core", "crfnet", "onnxruntime", "PIL", "platformdirs")
_IN_BLENDER = ("OpenImageIO", "PyOpenColorIO", "numpy")


def load(module: str) -> ModuleType:
    """Return a module: ``".work.run"`` is the add-on's own, ``"crfnet.report"`` is not; else raise an AddonError."""
    _expose_blenders_own()
    try:
        return importlib.import_module(module, __package__)
    except ImportError as problem:
        name = (problem.name or str(problem)).partition(".")[0]
        raise AddonError(f"{name} cannot be loaded: {_remedy(name)}") from problem


@cache
def missing() -> str:
    """Return, in one line, which library is missing or of another build, and what to do; an empty text if none is.

    It imports none of them, so it does not notice one that is damaged.
    """
    _expose_blenders_own()
    absent = [name for name in (*_IN_WHEELS, *_IN_BLENDER) if importlib.util.find_spec(name) is None]
    return f"{absent[0]} is missing: {_remedy(absent[0])}" if absent else _of_another_build()


def _of_another_build() -> str:
    """Return, in one line, that Blender will load the estimator of this zip at its next start; else an empty text."""
    manifest = tomllib.loads(Path(__file__).with_name("blender_manifest.toml").read_text(encoding="utf-8"))
    (wheel,) = (name for name in manifest["wheels"] if "/crfnet-" in name)
    expected, installed = wheel.split("-")[1], importlib.metadata.version("crfnet")
    if "+" not in expected or installed == expected:
        return ""
    return f"the add-on needs its estimator {expected}, but Blender has loaded {installed}: restart Blender"


def _expose_blenders_own() -> None:
    """Make Blender's own libraries importable where Blender is a Python module, which hides them."""
    expose = getattr(bpy.utils, "expose_bundled_modules", None)
    if expose is not None:
        expose()


def _remedy(name: str) -> str:
    """Return what to install to get a library."""
    if name in _IN_BLENDER:
        return "this build of Blender comes without it; use Blender from blender.org"
    python = "{}.{}".format(*sys.version_info)
    return (
        f"install the add-on again, from the zip for this system and Python {python} (for Blender of a Linux"
        " distribution, any_python)"
    )
