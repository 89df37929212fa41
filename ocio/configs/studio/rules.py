"""Which files of a plate get a rule in a config, and what for."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import PyOpenColorIO as OCIO

from ..file_rules import is_counter_name, linear_pattern, plate_pattern
from ..reference_space import LINEAR_NAMES, linear_space_name
from .looks import Look

#: The space of linear plates of which no header says more.
DEFAULT_LINEAR = "lin_rec709_scene"


@dataclass(frozen=True)
class PlateRules:
    """The files of a plate.

    Parameters
    ----------
    encoded, linear : tuple of str
        Patterns of the plate's files, and of its linear ones (`crfnet.configs.file_rules.rule_regex`).
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
            notes.append("no file rules: Blender's config is that of all projects; --rule PATTERN makes one")
        elif common and not patterns:
            first = common[0]
            notes.append(f"no file rule for {first}: many cameras give such names; --rule PATTERN makes one")
        encoded = patterns or _distinct(plate_pattern(name) for name in look.photographs if name not in common)
        space = _linear_space(config, set(look.linear.values()))
        if look.linear and not linear_patterns and space is None:
            notes.append(f"no file rule for {next(iter(look.linear))}: the config has no colour space as its header's")
        linear = linear_patterns or (_distinct(map(linear_pattern, look.linear)) if space else ())
        return cls(encoded, linear, space or DEFAULT_LINEAR, tuple(notes))


def _linear_space(config: OCIO.Config, stated: set[str]) -> str | None:
    """Return the config's space that the headers of linear plates state, or None if it has none."""
    primaries = [each for each in LINEAR_NAMES if each.interop_id and {each.interop_id} == stated]
    return linear_space_name(config, primaries[0]) if primaries else None


def _distinct(patterns: Iterable[str]) -> tuple[str, ...]:
    """Return the patterns without repetitions, in their order."""
    return tuple(dict.fromkeys(patterns))
