"""Which files of a plate get a rule in a config, and what for."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

import PyOpenColorIO as OCIO

from ocio.configs.file_rules import is_counter_name, plate_pattern
from ocio.configs.reference_space import LINEAR_REC709
from ocio.configs.studio.looks import Look

#: The space of linear plates of which no header says more.
DEFAULT_LINEAR = "lin_rec709_scene"

#: Names and roles of the spaces that headers of linear plates state (Color Interop Forum, "Color Space Encodings for
#: Texture Assets and CG Rendering"), in configs that do not know these names yet.
OTHER_NAMES = {
    DEFAULT_LINEAR: LINEAR_REC709,
    "lin_ap0_scene": ("aces_interchange",),
    "lin_ap1_scene": ("acescg", "ACEScg", "lin_ap1"),
    "lin_p3d65_scene": ("lin_p3d65", "Linear P3-D65"),
    "lin_rec2020_scene": ("lin_rec2020", "Linear Rec.2020"),
    "lin_adobergb_scene": ("lin_adobergb", "Linear AdobeRGB"),
}


@dataclass(frozen=True)
class PlateRules:
    """The files of a plate.

    Parameters
    ----------
    encoded, linear : tuple of str
        Patterns of the plate's files, and of its linear ones (`ocio.configs.file_rules.rule_regex`).
    linear_space : str
        The config's colour space of the linear ones.
    notes : tuple of str
        Which files get no rule, and why.
    """

    encoded: tuple[str, ...]
    linear: tuple[str, ...]
    linear_space: str
    notes: tuple[str, ...]

    @classmethod
    def of(
        cls,
        config: OCIO.Config,
        look: Look,
        patterns: Iterable[str] = (),
        linear_patterns: Iterable[str] = (),
        *,
        is_shared: bool = False,
    ) -> PlateRules:
        """Return the rules of a plate.

        A rule knows a file by its name alone. Names that cameras give again and again ("IMG_0001.JPG") would catch
        files of others, so they get a rule only if `patterns` ask for it. The names of linear plates end in
        "_linear.exr", which is ours, and always get one: without it a rule for all OpenEXR files would take them for
        ACES2065-1, as that of the ACES studio config 4.0 does.

        Parameters
        ----------
        config : PyOpenColorIO.Config
            The config, which must know the space of the linear plates.
        look : Look
            The plate.
        patterns, linear_patterns : iterable of str
            The files, if not those that the look names.
        is_shared : bool
            Whether the config is that of a program, for all projects.
        """
        patterns, linear_patterns = tuple(patterns), tuple(linear_patterns)
        common = sorted({name for name in look.photographs if is_counter_name(name)})
        notes = []
        if is_shared and not patterns:
            notes.append("no file rules: a Blender's config holds for all projects; --rule PATTERN makes one")
        elif common and not patterns:
            first = common[0]
            notes.append(f"no file rule for {first}: many cameras give such names; --rule PATTERN makes one")
        encoded = patterns or _distinct(plate_pattern(name) for name in look.photographs if name not in common)
        space = _linear_space(config, set(look.linear.values()))
        if look.linear and not linear_patterns and space is None:
            notes.append(f"no file rule for {next(iter(look.linear))}: the config has no colour space as its header's")
        linear = linear_patterns or (_distinct(map(_linear_pattern, look.linear)) if space else ())
        return cls(encoded, linear, space or DEFAULT_LINEAR, tuple(notes))


def _linear_space(config: OCIO.Config, stated: set[str]) -> str | None:
    """Return the config's space that the headers of linear plates state, or None if it has none."""
    names = [name for state in stated if len(stated) == 1 and state for name in (state, *OTHER_NAMES.get(state, ()))]
    spaces = filter(None, map(config.getColorSpace, names))
    return next((str(space.getName()) for space in spaces), None)


def _linear_pattern(name: str) -> str:
    """Return the pattern of a linear plate's file: its own name, with any frame number."""
    return re.sub(r"\.\d{2,}(?=_linear\.exr$)", ".#", name.replace("#", "?"))


def _distinct(patterns: Iterable[str]) -> tuple[str, ...]:
    """Return the patterns without repetitions, in their order."""
    return tuple(dict.fromkeys(patterns))
