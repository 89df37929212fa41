"""OpenColorIO configs that know a plate's colour space: a portable one, and additions to other people's.

Plain data first (`PlateColorSpace`), then the config made of it, then the file, which OpenColorIO's own processor
has checked before it takes its name.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath

import numpy as np
import PyOpenColorIO as OCIO
from numpy.typing import NDArray

from crfnet_core.errors import ConfigError
from crfnet_core.files import written_whole
from ocio.lut import Lut1D

#: The family of every plate's colour space, by which it is known again.
FAMILY = "Camera Response"

#: Names and aliases under which configs keep linear Rec.709, the most specific first.
LINEAR_REC709 = (
    "lin_rec709_scene",
    "lin_rec709_srgb",
    "lin_rec709",
    "lin_srgb",
    "Linear Rec.709 (sRGB)",
    "Linear Rec.709",
    "Utility - Linear - Rec.709",
    "Utility - Linear - sRGB",
)

#: Largest difference, relative above 1, between a config's processor and the LUT.
TOLERANCE = 1e-5

#: Linear Rec.709 to ACES2065-1, row by row; Bradford adaptation, as in the ACES configs.
REC709_TO_AP0 = (
    (0.439632981919, 0.382988698152, 0.177378319930),
    (0.089776442959, 0.813439428749, 0.096784128292),
    (0.017541170383, 0.111546553302, 0.870912276314),
)

#: What a portable config holds besides the plates. The names are Blender's, so that its files find their spaces.
PORTABLE = """\
ocio_profile_version: 2
environment: {}
search_path: "."
strictparsing: true
luma: [0.2126, 0.7152, 0.0722]
name: crfnet
description: Camera responses estimated from photographs; scene-linear is Rec.709 with a D65 white.
roles:
  aces_interchange: ACES2065-1
  cie_xyz_d65_interchange: CIE-XYZ-D65
  color_picking: sRGB
  color_timing: ACEScct
  compositing_log: ACEScct
  data: Non-Color
  default_byte: sRGB
  default_float: Linear Rec.709
  default_sequencer: sRGB
  matte_paint: sRGB
  reference: Linear Rec.709
  rendering: Linear Rec.709
  scene_linear: Linear Rec.709
  texture_paint: sRGB
file_rules:
  - !<Rule> {name: Scene-linear files, colorspace: scene_linear, regex: '.*\\.([eE][xX][rR]|[hH][dD][rR])'}
  - !<Rule> {name: Display-encoded files, colorspace: sRGB, regex: '.*\\.([pP][nN][gG]|[jJ][pP][eE]?[gG])'}
  - !<Rule> {name: Default, colorspace: Non-Color}
displays:
  sRGB:
    - !<View> {name: Standard, view_transform: Un-tone-mapped, display_colorspace: sRGB - Display}
    - !<View> {name: Raw, colorspace: Non-Color}
  Rec.709:
    - !<View> {name: Standard, view_transform: Un-tone-mapped, display_colorspace: Rec.1886 Rec.709 - Display}
    - !<View> {name: Raw, colorspace: Non-Color}
active_displays: [sRGB, Rec.709]
active_views: [Standard, Raw]
default_view_transform: Un-tone-mapped
view_transforms:
  - !<ViewTransform>
    name: Un-tone-mapped
    description: Scene-linear light shown as it is, clipped at display white.
    from_scene_reference: !<MatrixTransform> {matrix: [0.412390799266, 0.357584339384, 0.180480788402, 0, \
0.212639005872, 0.715168678768, 0.072192315361, 0, 0.019330818716, 0.119194779795, 0.950532152250, 0, 0, 0, 0, 1]}
display_colorspaces:
  - !<ColorSpace>
    name: CIE-XYZ-D65
    aliases: [cie_xyz_d65]
    description: CIE XYZ with a D65 white, through which displays are connected.
    bitdepth: 32f
  - !<ColorSpace>
    name: sRGB - Display
    aliases: [srgb_display, srgb_rec709_display]
    family: Display
    encoding: sdr-video
    description: An sRGB monitor (IEC 61966-2-1, piecewise).
    bitdepth: 32f
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}
  - !<ColorSpace>
    name: Rec.1886 Rec.709 - Display
    aliases: [rec1886_rec709_display]
    family: Display
    encoding: sdr-video
    description: An HD video monitor (Rec.709 primaries, Rec.1886 EOTF).
    bitdepth: 32f
    from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_REC.1886-REC.709}
colorspaces:
  - !<ColorSpace>
    name: Linear Rec.709
    aliases: [lin_rec709_scene, lin_rec709, lin_rec709_srgb, lin_srgb, Linear, Linear Rec.709 (sRGB), Linear BT.709, \
Utility - Linear - Rec.709, Utility - Linear - sRGB]
    family: Scene-linear
    encoding: scene-linear
    description: Scene-linear light, Rec.709 primaries, D65 white; the reference.
    bitdepth: 32f
  - !<ColorSpace>
    name: ACES2065-1
    aliases: [aces2065_1, lin_ap0, lin_ap0_scene]
    family: Scene-linear
    encoding: scene-linear
    description: Scene-linear light, ACES AP0 primaries, for exchange between configs.
    bitdepth: 32f
    from_reference: !<MatrixTransform> {matrix: REC709_TO_AP0}
  - !<ColorSpace>
    name: ACEScg
    aliases: [acescg, lin_ap1, lin_ap1_scene]
    family: Scene-linear
    encoding: scene-linear
    description: Scene-linear light, ACES AP1 primaries.
    bitdepth: 32f
    to_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
        - !<MatrixTransform> {matrix: REC709_TO_AP0, direction: inverse}
  - !<ColorSpace>
    name: ACEScct
    aliases: [acescct_ap1]
    family: Log
    encoding: log
    description: Logarithmic light, ACES AP1 primaries, for grading.
    bitdepth: 32f
    to_reference: !<GroupTransform>
      children:
        - !<BuiltinTransform> {style: ACEScct_to_ACES2065-1}
        - !<MatrixTransform> {matrix: REC709_TO_AP0, direction: inverse}
  - !<ColorSpace>
    name: sRGB
    aliases: [sRGB - Texture, srgb_tx, srgb_texture, srgb_rec709_scene, Utility - sRGB - Texture]
    family: Display-encoded
    encoding: sdr-video
    description: Textures and pictures without a response of their own (IEC 61966-2-1, piecewise).
    bitdepth: 32f
    to_reference: !<ExponentWithLinearTransform> {gamma: 2.4, offset: 0.055}
  - !<ColorSpace>
    name: Non-Color
    aliases: [Raw, Utility - Raw, Non-Colour Data, Generic Data]
    family: Data
    encoding: data
    description: Numbers that are no colours (masks, normals, depth); never converted.
    bitdepth: 32f
    isdata: true
"""


@dataclass(frozen=True)
class PlateColorSpace:
    """The colour space of a plate: its camera's inverse response, to linear Rec.709.

    Parameters
    ----------
    name : str
        As users pick it, for example "CRF plate01".
    lut_file : str
        The LUT from brightness to irradiance, named relative to the config's folder.
    aliases : tuple of str
        Other names of the space.
    description : str
        What it was estimated from.
    encoding : str
        OpenColorIO's encoding.
    file_pattern : str or None
        The names of the plate's files with `*` and `?`, for example "shot_plate01.*.png", for a file rule; matched
        in any folder, case by case.
    exposure : float
        Stops added after the response.

    Raises
    ------
    ConfigError
        If the name is empty, the exposure is not finite, or the LUT lies outside the config's folder or has a name
        that OpenColorIO would take for a variable.
    """

    name: str
    lut_file: str
    aliases: tuple[str, ...] = ()
    description: str = ""
    encoding: str = "sdr-video"
    file_pattern: str | None = None
    exposure: float = 0.0

    def __post_init__(self) -> None:
        lut_file = PureWindowsPath(self.lut_file)
        if not self.name.strip():
            raise ConfigError("a colour space needs a name, found an empty one")
        if not np.isfinite(self.exposure):
            raise ConfigError(f"{self.name}: the exposure must be a number of stops, found {self.exposure}")
        if not lut_file.name or lut_file.anchor or ".." in lut_file.parts:
            message = f"{self.lut_file!r} is no name within the config's folder; put the LUT beside the config"
            raise ConfigError(f"{self.name}: {message}")
        if set(self.lut_file) & set("$%"):
            raise ConfigError(f"{self.name}: OpenColorIO takes $ and % in {self.lut_file!r} for variables; rename it")


def portable_config(spaces: Sequence[PlateColorSpace]) -> OCIO.Config:
    """Return a profile 2.0 config with `spaces`, for every host from OpenColorIO 2.0 on.

    Its reference and scene-linear space is linear Rec.709 with a D65 white.

    Parameters
    ----------
    spaces : sequence of PlateColorSpace
        The plates, of different names.

    Raises
    ------
    ConfigError
        If two spaces share a name or an alias, or one takes a name of the config.
    """
    rows = [str([*row, 0])[1:-1] for row in REC709_TO_AP0]
    config = OCIO.Config.CreateFromStream(PORTABLE.replace("REC709_TO_AP0", f"[{', '.join(rows)}, 0, 0, 0, 1]"))
    names = [space.name.casefold() for space in spaces]
    for index, space in enumerate(spaces):
        if names.index(names[index]) != index:
            raise ConfigError(f"{space.name}: two plates have this name; rename one")
        config = add_plate_color_space(config, space)
    return config


def add_plate_color_space(config: OCIO.Config, space: PlateColorSpace) -> OCIO.Config:
    """Return a copy of `config` with a plate's colour space and its file rule, before all others.

    The profile version, the rules and everything else stay. What follows the response, from linear Rec.709 to the
    config's reference space, is taken from the config's own linear Rec.709 space, or else goes by its
    `aces_interchange` role. A config of profile version 1 knows neither aliases nor file rules: they are left out.

    Parameters
    ----------
    config : PyOpenColorIO.Config
        Any config; it is not changed.
    space : PlateColorSpace
        The plate's colour space. It replaces an earlier one of its name in the family `FAMILY`.

    Raises
    ------
    ConfigError
        If the config has the name for something else, or no way from linear Rec.709 to its reference space.
    """
    config = copy.deepcopy(config)
    modern = config.getMajorVersion() >= 2
    _remove_earlier(config, space)
    try:
        color_space = OCIO.ColorSpace(
            name=space.name,
            aliases=list(space.aliases) if modern else [],
            family=FAMILY,
            encoding=space.encoding,
            description=space.description,
            bitDepth=OCIO.BIT_DEPTH_F32,
            toReference=_to_reference(config, space),
        )
        config.addColorSpace(color_space)
        if modern and space.file_pattern is not None:
            rules = config.getFileRules()
            rules.insertRule(0, space.name, space.name, _rule_regex(space.file_pattern))
            config.setFileRules(rules)
    except OCIO.Exception as problem:
        raise ConfigError(f"{space.name}: cannot be added to the config ({_one_line(problem)})") from problem
    folders = [folder for folder in config.getSearchPaths() if folder not in ("", ".")]
    config.clearSearchPaths()
    for folder in (*folders, "."):
        config.addSearchPath(folder)
    return config


def write_config(path: str | Path, config: OCIO.Config, *, check: Mapping[str, Lut1D], overwrite: bool = False) -> None:
    """Write a config, once OpenColorIO has read it back, validated it and converted as its LUTs do.

    Parameters
    ----------
    path : str or Path
        The file to be written, in the folder that holds the LUTs.
    config : PyOpenColorIO.Config
        The config.
    check : mapping of str to Lut1D
        Plates' colour spaces by name, and their LUTs: the processor must equal them in both directions to
        `TOLERANCE`, times the exposure that the config gives the plate.
    overwrite : bool
        Whether an existing file may be replaced.

    Raises
    ------
    ConfigError
        If the config does not load, validate or convert so, or cannot be written; no file is left behind then.
    """
    OCIO.ClearAllCaches()
    try:
        with written_whole(path, overwrite=overwrite, error=ConfigError) as temporary:
            temporary.write_text(config.serialize(), encoding="utf-8", newline="\n")
            loaded = OCIO.Config.CreateFromFile(str(temporary))
            loaded.validate()
            for name, lut in check.items():
                _check_conversion(loaded, name, lut)
    except (OCIO.Exception, OCIO.ExceptionMissingFile) as problem:
        raise ConfigError(f"{path}: not written, OpenColorIO refuses it ({_one_line(problem)})") from problem


def _remove_earlier(config: OCIO.Config, space: PlateColorSpace) -> None:
    """Remove an earlier version of a plate's space and its rule; a ConfigError if the name is someone else's."""
    earlier = config.getColorSpace(space.name)
    if earlier is None:
        return
    if earlier.getFamily() != FAMILY or earlier.getName().casefold() != space.name.casefold():
        raise ConfigError(f"{space.name}: the config uses this name for {earlier.getName()!r}; choose another name")
    config.removeColorSpace(earlier.getName())
    rules = config.getFileRules()
    for index in reversed(range(rules.getNumEntries())):
        if rules.getName(index).casefold() == space.name.casefold():
            rules.removeRule(index)
    config.setFileRules(rules)


def _to_reference(config: OCIO.Config, space: PlateColorSpace) -> OCIO.Transform:
    """Return the response, the exposure and the way from linear Rec.709 to the reference space, as one transform."""
    file_name = space.lut_file.replace("\\", "/")
    steps: list[OCIO.Transform] = [OCIO.FileTransform(src=file_name, interpolation=OCIO.INTERP_LINEAR)]
    if space.exposure:
        steps.append(OCIO.ExposureContrastTransform(OCIO.EXPOSURE_CONTRAST_LINEAR, exposure=space.exposure))
    steps += _rec709_to_reference(config)
    return steps[0] if len(steps) == 1 else OCIO.GroupTransform(steps)


def _rec709_to_reference(config: OCIO.Config) -> list[OCIO.Transform]:
    """Return the transforms from linear Rec.709 to the config's scene reference space."""
    for name in LINEAR_REC709:
        found = config.getColorSpace(name)
        if found is not None and found.getReferenceSpaceType() == OCIO.REFERENCE_SPACE_SCENE:
            return _space_to_reference(found)
    interchange = config.getColorSpace("aces_interchange")
    if interchange is not None:
        return [_matrix(np.array(REC709_TO_AP0)), *_space_to_reference(interchange)]
    raise ConfigError("the config has neither a space 'lin_rec709_scene' nor a role aces_interchange; add one")


def _space_to_reference(space: OCIO.ColorSpace) -> list[OCIO.Transform]:
    """Return a colour space's transforms to its reference, whichever direction it defines."""
    forward = space.getTransform(OCIO.COLORSPACE_DIR_TO_REFERENCE)
    if forward is not None:
        return [forward]
    backward = space.getTransform(OCIO.COLORSPACE_DIR_FROM_REFERENCE)
    return [] if backward is None else [OCIO.GroupTransform([backward], OCIO.TRANSFORM_DIR_INVERSE)]


def _matrix(rows: NDArray[np.float64]) -> OCIO.MatrixTransform:
    """Return a transform that multiplies RGB by a 3 x 3 matrix."""
    square = np.eye(4)
    square[:3, :3] = rows
    return OCIO.MatrixTransform(matrix=square.ravel().tolist())


def _rule_regex(pattern: str) -> str:
    """Return the regular expression, for any C++ library, of file names with * and ? in any folder."""
    escaped = re.sub(r"([.^$+(){}|\[\]\\])", r"\\\1", pattern)
    return r"(.*[/\\])?" + escaped.replace("*", r"[^/\\]*").replace("?", r"[^/\\]")


def _check_conversion(config: OCIO.Config, name: str, lut: Lut1D) -> None:
    """Raise a ConfigError unless a colour space converts as its LUT does, in both directions."""
    space = config.getColorSpace(name)
    if space is None:
        raise ConfigError(f"{name}: the config has no such colour space; add it before writing")
    low, high = lut.domain
    margin = (high - low) / 8
    brightness = np.linspace(low - margin, high + margin, 4096, dtype=np.float32)
    linear = OCIO.ColorSpace(name="crfnet check", toReference=OCIO.GroupTransform(_rec709_to_reference(config)))
    config.addColorSpace(linear)
    gain = np.float32(2 ** _exposure(space))
    expected = lut.apply(brightness) * gain
    irradiance = _converted(config, name, linear.getName(), brightness)
    back = _converted(config, linear.getName(), name, expected)
    scale = np.maximum(np.abs(expected), 1)
    forward = np.abs(irradiance - expected) / scale
    backward = np.minimum(np.abs(back - lut.apply_inverse(expected / gain)), np.abs(lut.apply(back) * gain - expected))
    worst = max(float(forward.max()), float((backward / scale).max()))
    if not worst <= TOLERANCE:
        raise ConfigError(f"{name}: converts other than its LUT by {worst:.2g}; write the LUT and the config again")


def _exposure(space: OCIO.ColorSpace) -> float:
    """Return the stops that a plate's colour space adds after its LUT."""
    transform = space.getTransform(OCIO.COLORSPACE_DIR_TO_REFERENCE)
    steps = list(transform) if isinstance(transform, OCIO.GroupTransform) else [transform]
    return sum(float(step.getExposure()) for step in steps if isinstance(step, OCIO.ExposureContrastTransform))


def _converted(config: OCIO.Config, source: str, target: str, values: NDArray[np.floating]) -> NDArray[np.float32]:
    """Return gray pixels, shape (N,), converted from one colour space to another."""
    pixels = np.repeat(values.astype(np.float32), 3)
    config.getProcessor(source, target).getOptimizedCPUProcessor(OCIO.OPTIMIZATION_NONE).applyRGB(pixels)
    return pixels[::3]


def _one_line(problem: Exception) -> str:
    """Return the text of OpenColorIO's error on one line."""
    return " ".join(str(problem).split())
