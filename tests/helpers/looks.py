"""Folders as `crfnet estimate` writes them, small, without an estimate; and configs that such plates were added to."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import PyOpenColorIO as OCIO

from crfnet.configs.derived import write_derived_config
from crfnet.configs.files import write_config
from crfnet.configs.looks import read_looks
from crfnet.configs.plate_color_space import PlateColorSpace
from crfnet.configs.portable import portable_config
from crfnet.configs.sources import find_config
from crfnet.luts.files import write_lut
from crfnet.luts.lut1d import inverse_response_lut
from crfnet.output_files import OutputFiles
from crfnet_core.colorimetry import REC709
from crfnet_core.response.curve import ResponseCurve
from tests.helpers.configs import rule_names
from tests.helpers.images import write_image

#: A response that is not a power law, so that no config has a space that converts as it does.
LUT = inverse_response_lut(
    ResponseCurve.from_samples(np.linspace(0, 1, 1024) ** 0.4 * (1.2 - 0.2 * np.linspace(0, 1, 1024)))
)

OTHER_LUT = inverse_response_lut(ResponseCurve.gamma(1.8))

#: Of all built-in configs, it reads every OpenEXR file as ACES2065-1.
STUDIO = "studio-config-v4.0.0_aces-v2.0_ocio-v2.5"

#: The color space of `write_look`.
NAME = "CRF plate01"

CORNERS = ("red", "green", "blue", "white")


def write_look(
    folder,
    photographs=("plate01.jpg",),
    *,
    lut=LUT,
    exposure=0.0,
    interop_id="lin_rec709_scene",
    primaries=REC709,
    sequence="",
):
    """Write LUT, document, config and linear plates of photographs with these names, and return the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    files = OutputFiles.named(folder, [Path(name) for name in photographs])
    write_lut(files.lut, lut, overwrite=True)
    space = PlateColorSpace.from_outputs(files, Path(photographs[0]), exposure=exposure)
    space = replace(space, primaries=primaries)
    write_config(files.config, portable_config([space]), check={space.name: lut}, overwrite=True)
    for path in files.linear:
        write_image(path, np.zeros((2, 2, 3), np.float32), colorInteropID=interop_id)
    document = {
        "photographs": [{"name": name} for name in photographs],
        "color_space": files.color_space,
        "exposure": {"stops": exposure},
        "output_space": {"name": interop_id, "interop_id": interop_id},
        "primaries": {"name": primaries.name, **{corner: getattr(primaries, corner) for corner in CORNERS}},
        "files": {"spi1d": files.lut.name, "config": files.config.name, "linear": [path.name for path in files.linear]},
    }
    document |= {"sequence": sequence} if sequence else {}
    files.report.write_text(json.dumps(document), encoding="utf-8")
    return folder


def add(base, out, *looks, overwrite=False):
    """Write a config with looks added to a base."""
    read = [look for path in looks for look in read_looks(path)]
    return write_derived_config(find_config(str(base)), out, read, overwrite=overwrite)


def space_of(config, path):
    """Return the color space that a config's rules give a file."""
    return str(config.getColorSpaceFromFilepath(path)[0])


def all_names(config):
    """Return everything of a config that has a name, but plates and their rules."""
    every = (OCIO.SEARCH_REFERENCE_SPACE_ALL, OCIO.COLORSPACE_ALL)
    return {
        "version": (config.getMajorVersion(), config.getMinorVersion()),
        "roles": dict(config.getRoles()),
        "spaces": [name for name in config.getColorSpaceNames(*every) if "CRF" not in name],
        "named transforms": list(config.getNamedTransformNames()),
        "view transforms": list(config.getViewTransformNames()),
        "default view transform": config.getDefaultViewTransformName(),
        "looks": list(config.getLookNames()),
        "views": {name: list(config.getViews(name)) for name in config.getDisplaysAll()},
        "rules": [name for name in rule_names(config) if "CRF" not in name],
        "description": config.getDescription(),
        "environment": {name: config.getEnvironmentVarDefault(name) for name in config.getEnvironmentVarNames()},
    }
