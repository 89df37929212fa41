"""A config of plates alone, and the merge file with which OpenColorIO 2.5 and later lay it over a studio's config.

Its scene reference is ACES2065-1, as that of the ACES configs: a colour space that is taken out of it alone converts
right there, and the merger converts it for configs with another reference. It has no file rules, no data space and no
role that could replace the studio's. The merger must not look for duplicates: it would take a plate for any space that
converts alike (a camera's response near gamma 2.2 replaced the studio's "Gamma 2.2 Encoded Rec.709").
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import PyOpenColorIO as OCIO

from crfnet_core.files import atomic_write_text, check_target

from ...errors import ConfigError
from ...luts.files import write_lut
from ...output_files import check_config_folder, output_folder
from ..files import write_config
from ..installation_record import own_folder
from ..plate_color_space import add_plate_color_space
from ..undo import as_before_on_failure
from .aces_check import check_in_ap0
from .additions import own_space
from .looks import Look
from .plates import PlateInConfig, plates_in_config
from .sources import ConfigSource

#: The config without plates.
TEMPLATE = """\
ocio_profile_version: 2
environment: {}
search_path: "."
strictparsing: true
description: Plates' colour spaces, to be merged into another config; not for use on its own.
roles:
  aces_interchange: ACES2065-1
  default: ACES2065-1
  scene_linear: ACES2065-1
displays:
  None:
    - !<View> {name: None, colorspace: ACES2065-1}
colorspaces:
  - !<ColorSpace>
    name: ACES2065-1
    encoding: scene-linear
    bitdepth: 32f
"""

#: The merge file; nothing but colour spaces is taken over, and the studio's own win.
MERGE = """\
ociom_version: 1.0
search_path: .
merge:
  merged:
    base: {base}
    input: {overlay}
    options:
      input_first: false
      default_strategy: BaseOnly
      avoid_duplicates: false
      adjust_input_reference_space: true
    params:
      colorspaces:
        strategy: PreferBase
"""


@dataclass(frozen=True)
class Overlay:
    """What was written.

    Parameters
    ----------
    config : Path
        The config of the plates.
    merge_file : Path
        The merge file for ociomergeconfigs.
    plates : tuple of PlateInConfig
        The plates.
    """

    config: Path
    merge_file: Path
    plates: tuple[PlateInConfig, ...]


def write_overlay(base: ConfigSource, target: Path, looks: Sequence[Look], *, overwrite: bool = False) -> Overlay:
    """Write a config of plates alone, its LUTs, and a merge file that lays it over `base`.

    Parameters
    ----------
    base : ConfigSource
        The config to merge with; it is only named in the merge file.
    target : Path
        The config to be written. The merge file has its name, with .ociom.
    looks : sequence of Look
        The plates; the second of a name gets its folder's name.
    overwrite : bool
        Whether existing files may be replaced.

    Raises
    ------
    ConfigError, LutError, PlateError
        If `base` has a plate's colour space already, which OpenColorIO would prefer; the files cannot be written; or
        OpenColorIO converts otherwise than the LUTs.
    """
    target = target.resolve()
    merge_file = target.with_suffix(".ociom")
    check_config_folder(target.parent)
    if target == base.path:
        raise ConfigError(f"{target}: is the config to merge with; choose another name for the overlay")
    config, added = OCIO.Config.CreateFromStream(TEMPLATE), dict[str, Look]()
    for look in looks:
        space = own_space(config, look, target, {name: str(other.source) for name, other in added.items()})
        config = add_plate_color_space(config, space)
        added[space.name] = look
    for name in added:
        if base.config.getColorSpace(name) is not None:
            raise ConfigError(
                f"{base.name}: has a colour space {name!r}, which would win over that of the overlay; take it out"
                " (crfnet config remove), or add the plate to a copy of the config (crfnet config add --out)"
            )
    plates = plates_in_config(config)
    files = {target.parent / plate.lut_file: added[plate.name].lut for plate in plates}
    text = MERGE.format(base=_quoted(base.name), overlay=_quoted(target.name))
    with output_folder(own_folder(target)):
        for path in (target, merge_file):
            check_target(path, overwrite=overwrite, error=ConfigError)
        with as_before_on_failure([*files, target, merge_file]):
            for path, lut in files.items():
                write_lut(path, lut, overwrite=overwrite)
            check_in_ap0(config, target.parent, added)
            write_config(target, config, check={name: look.lut for name, look in added.items()}, overwrite=overwrite)
            atomic_write_text(merge_file, text, overwrite=overwrite, error=ConfigError)
    return Overlay(target, merge_file, tuple(plates))


def _quoted(text: str) -> str:
    """Return a text as YAML."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
