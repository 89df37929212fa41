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

#: The attribute of the imported package `crfnet` with its version.
_IMPORTED = "version_imported_by_the_addon"


def load(module: str) -> ModuleType:
    """Return a module: ``".work.run"`` is the add-on's own, ``"crfnet.report"`` is not; else raise an AddonError."""
    _expose_blenders_own()
    try:
        imported = importlib.import_module(module, __package__)
        names = vars(importlib.import_module("crfnet"))
        if _IMPORTED not in names:  # to look it up takes longer than to find a module again
            names[_IMPORTED] = importlib.metadata.version("crfnet")
        return imported
    except ImportError as problem:
        name = (problem.name or str(problem)).partition(".")[0]
        raise AddonError(f"{name} cannot be loaded: {_remedy(name)}") from problem


def missing() -> str:
    """Return, in one line, why the add-on cannot be used, and what to do; an empty text if it can.

    A library is missing or of another build, or two copies of the add-on are enabled: Blender uses the older one or the
    newer one, whichever it has enabled last.
    """
    name = str(__package__).rpartition(".")[2]
    modules = [addon.module for addon in bpy.context.preferences.addons]
    copies = [module for module in modules if module.rpartition(".")[2] == name]
    if len(copies) < 2:
        return _missing_library()
    names = {f"bl_ext.{each.module}.{name}": each.name for each in bpy.context.preferences.extensions.repos}
    places = " or ".join(names.get(module, module) for module in copies)
    return f"The add-on is installed twice: in Preferences, Get Extensions, uninstall the copy of {places}"


@cache
def _missing_library() -> str:
    """Return, in one line, which library is missing or of another build, and what to do; an empty text if none is.

    It imports none of them, so it does not notice one that is damaged.
    """
    _expose_blenders_own()
    absent = [name for name in (*_IN_WHEELS, *_IN_BLENDER) if importlib.util.find_spec(name) is None]
    return f"The library {absent[0]} is missing: {_remedy(absent[0])}" if absent else _of_another_build()


def _of_another_build() -> str:
    """Return, in one line, that another build of the estimator is loaded than this zip's; else an empty text.

    Blender replaces the wheels of an add-on at an update or when the next session starts, but keeps what is imported.
    """
    manifest = tomllib.loads(Path(__file__).with_name("blender_manifest.toml").read_text(encoding="utf-8"))
    (wheel,) = (name for name in manifest["wheels"] if "/crfnet-" in name)
    imported = vars(sys.modules["crfnet"]).get(_IMPORTED) if "crfnet" in sys.modules else None
    expected, installed = wheel.split("-")[1], imported or importlib.metadata.version("crfnet")
    if "+" not in expected or installed == expected:
        return ""
    return f"The add-on needs its estimator {expected}, but Blender has loaded {installed}: restart Blender"


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
