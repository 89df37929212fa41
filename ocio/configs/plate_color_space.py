"""The color space of a plate, as plain data (`PlateColorSpace`) and as a part of any OpenColorIO config."""

import re
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path, PureWindowsPath
from typing import Self

import PyOpenColorIO as OCIO

from crfnet_core.colorimetry import REC709, Primaries, conversion_matrix
from crfnet_core.photograph.image_io import PHOTOGRAPH_SUFFIXES

from ..defaults import MOST_STOPS
from ..errors import ConfigError
from ..output_files import OutputFiles
from .file_rules import (
    FAMILY,
    LINEAR,
    FileClaim,
    add_file_rules,
    is_counter_name,
    linear_patterns,
    plate_pattern,
    plate_rules,
)
from .files import load_config, plate_exposure
from .reference_space import linear_space_name, matrix_transform, rec709_to_reference, steps_to_reference

#: The category of the spaces of files, by which hosts sort their menus.
CATEGORIES = ["file-io"]


@dataclass(frozen=True)
class PlateColorSpace:
    """The color space of a plate: its camera's inverse response, an exposure, and its primaries.

    Raise a ConfigError if the name is empty, the exposure is not finite, the LUT lies outside the config's folder, or
    its name holds a character that OpenColorIO interprets as a variable.
    """

    name: str  # in menus, for example "CRF plate01"
    lut_file: str  # from brightness to irradiance, relative to the config's folder
    aliases: tuple[str, ...] = ()  # a config gets those that it does not use already
    description: str = ""
    file_patterns: tuple[str, ...] = ()  # the plate's file names, for a file rule: see `file_rules.rule_regex`
    exposure: float = 0.0  # stops after the response: a separate transform, to be edited in the config
    primaries: Primaries = REC709  # of the encoded plate
    linear_patterns: tuple[str, ...] = ()  # the names of the plate's linear files, for a second file rule
    linear_primaries: Primaries | None = None  # of those files; None if they are not known, which makes no rule

    def __post_init__(self) -> None:
        lut_file = PureWindowsPath(self.lut_file)
        if not self.name.strip():
            raise ConfigError("nameless_color_space")
        if not abs(self.exposure) <= MOST_STOPS:  # also NaN
            raise ConfigError("exposure_not_finite", name=self.name, exposure=self.exposure, most=MOST_STOPS)
        if not lut_file.name or lut_file.anchor or ".." in lut_file.parts:
            raise ConfigError("lut_outside_config_folder", name=self.name, lut_file=self.lut_file)
        if set(self.lut_file) & set("$%"):
            raise ConfigError("lut_name_is_variable", name=self.name, lut_file=self.lut_file)

    @classmethod
    def from_outputs(cls, files: OutputFiles, photo: Path, *, exposure: float = 0.0, file_pattern: str = "") -> Self:
        """Return the color space of a photograph, for a config next to the LUTs that an estimate writes.

        `file_pattern` is by default the photograph's name, where a frame number at the end (shot.0001.jpg) stands for
        any. Raise a ConfigError if no color space can have the name.
        """
        is_movie = photo.suffix.lower() not in (*PHOTOGRAPH_SUFFIXES, ".exr")
        linear = [path.name for path in files.linear]
        name = files.color_space
        return cls(
            name=name,
            lut_file=files.lut.name,
            # of "CRF a_b" crf_a_b; of "CRF a-b" none, since it would be the same
            aliases=(name.replace(" ", "_").lower(),) if re.fullmatch(r"CRF \w+", name) else (),
            description=f"The inverse response of the camera that took {photo.name}, as crfnet estimated it",
            file_patterns=(file_pattern or plate_pattern(photo.name),),
            exposure=exposure,
            linear_patterns=linear_patterns(files.lut.stem, linear, file_pattern, is_movie=is_movie),
        )


def add_plate_color_spaces(
    config: OCIO.Config, spaces: Sequence[PlateColorSpace], *, has_counters: bool = True
) -> tuple[str, ...]:
    """Add plates' color spaces and file rules to a config, in place; return the patterns that get no rule.

    Profile version 1 has neither aliases nor file rules: they are left out there, and so is an exposure of 0. Files of
    several plates get no rule, nor do linear ones without a space; nor, without `has_counters`, do names of cameras.
    Raise a ConfigError if the config has one of the names already, or cannot convert linear Rec.709 to its reference.
    """
    for space in spaces:
        _add_color_space(config, space)
    claims = [claim for space in spaces for claim in _claims(config, space, has_counters=has_counters)]
    if config.getMajorVersion() < 2:
        return tuple(dict.fromkeys(pattern for claim in claims for pattern in claim.patterns))
    return add_file_rules(config, claims)


def _claims(config: OCIO.Config, space: PlateColorSpace, *, has_counters: bool) -> Iterator[FileClaim]:
    """Yield which files of a plate are to have which color space of a config."""
    linear = linear_space_name(config, space.linear_primaries) if space.linear_primaries else None
    rules = {space.name + LINEAR: (linear, space.linear_patterns), space.name: (space.name, space.file_patterns)}
    for rule, (target, patterns) in rules.items():
        counters = [] if has_counters else [pattern for pattern in patterns if is_counter_name(pattern)]
        yield FileClaim(rule, target or "", tuple(pattern for pattern in patterns if pattern not in counters))
        yield FileClaim(rule, "", tuple(counters))


def _add_color_space(config: OCIO.Config, space: PlateColorSpace) -> None:
    """Add the color space of a plate to a config, in place."""
    if (taken := config.getColorSpace(space.name)) is not None:
        raise ConfigError("color_space_exists", name=space.name, taken=taken.getName())
    modern = config.getMajorVersion() >= 2
    try:
        config.addColorSpace(
            OCIO.ColorSpace(
                name=space.name,
                aliases=[alias for alias in space.aliases if modern and config.getColorSpace(alias) is None],
                family=FAMILY,
                encoding="sdr-video",
                description=space.description,
                bitDepth=OCIO.BIT_DEPTH_F32,
                categories=CATEGORIES if modern else [],
                toReference=_to_reference(config, space),
            )
        )
    except OCIO.Exception as problem:
        raise ConfigError("color_space_refused", name=space.name, reason=problem) from problem


def _to_reference(config: OCIO.Config, space: PlateColorSpace) -> OCIO.Transform:
    """Return the LUT, the exposure, and the matrices from the plate's primaries to the reference space."""
    file_name = space.lut_file.replace("\\", "/")
    steps: list[OCIO.Transform] = [OCIO.FileTransform(src=file_name, interpolation=OCIO.INTERP_LINEAR)]
    if config.getMajorVersion() < 2 and space.exposure:
        raise ConfigError("exposure_in_version_1", name=space.name, exposure=space.exposure)
    if config.getMajorVersion() >= 2:
        steps.append(OCIO.ExposureContrastTransform(OCIO.EXPOSURE_CONTRAST_LINEAR, exposure=space.exposure))
    if space.primaries != REC709:
        steps.append(matrix_transform(conversion_matrix(space.primaries, REC709)))
    return OCIO.GroupTransform([*steps, *rec709_to_reference(config)])


@dataclass(frozen=True)
class PlateInConfig:
    """A plate's color space in a config: its name, its LUT as the config names it, and the stops added after the LUT.

    `rules` holds the color space that each of its file rules gives, by the rule's regular expression.
    """

    name: str
    lut_file: str
    exposure: float
    rules: dict[str, str]


def plates_in_config(config: OCIO.Config) -> list[PlateInConfig]:
    """Return the plates of a config, in its order, those that are hidden from menus, too."""
    names = config.getColorSpaceNames(OCIO.SEARCH_REFERENCE_SPACE_SCENE, OCIO.COLORSPACE_ALL)
    return [_plate(config, space) for space in map(config.getColorSpace, names) if space.getFamily() == FAMILY]


def lost_plates(path: Path, kept: Collection[str]) -> list[str]:
    """Return the names of a config's plates that are not `kept`; none of a file that is absent or cannot be read."""
    with suppress(ConfigError):
        return [plate.name for plate in plates_in_config(load_config(path)) if plate.name not in kept]
    return []


def _plate(config: OCIO.Config, space: OCIO.ColorSpace) -> PlateInConfig:
    """Return the plate of a color space; its LUT comes first."""
    name, first = str(space.getName()), next(iter(steps_to_reference(space)), None)
    lut_file = str(first.getSrc()) if isinstance(first, OCIO.FileTransform) else ""
    return PlateInConfig(name, lut_file, plate_exposure(space), plate_rules(config, name))
