"""A plate's colour space, added to any OpenColorIO config, and the config written once it converts as its LUT does.

Plain data first (`PlateColorSpace`), then the config made of it, then the file, which OpenColorIO's own processor
has checked before it takes its name.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath

import numpy as np
import PyOpenColorIO as OCIO
from numpy.typing import NDArray

from crfnet_core.errors import ConfigError, one_line
from crfnet_core.files import atomic_write
from ocio.luts.lut1d import Lut1D

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
        raise ConfigError(f"{space.name}: cannot be added to the config ({one_line(problem)})") from problem
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
        with atomic_write(path, overwrite=overwrite, error=ConfigError) as temporary:
            temporary.write_text(config.serialize(), encoding="utf-8", newline="\n")
            loaded = OCIO.Config.CreateFromFile(str(temporary))
            loaded.validate()
            for name, lut in check.items():
                _check_conversion(loaded, name, lut)
    except (OCIO.Exception, OCIO.ExceptionMissingFile) as problem:
        raise ConfigError(f"{path}: not written, OpenColorIO refuses it ({one_line(problem)})") from problem


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
