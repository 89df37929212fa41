"""File rules of a config: which files are a plate's, by their full names in upper or lower case."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

import PyOpenColorIO as OCIO

#: What a rule for linear plates is called after the plate's colour space.
LINEAR_SUFFIX = " linear"

#: File names, without suffix, that cameras and programs give again and again, in lower case: four characters and a
#: number of four digits or five (JEITA CP-3461, "Design rule for Camera File system", and its followers), a number
#: alone, and what programs call a picture that nobody has named.
COUNTER_NAMES = (
    r"[a-z0-9_]{3,4}_?\d{4,5}",
    r"img_e?\d{4,5}",
    r"(gopr|gp|gx|gh|dji|mvi|img|dsc|dscf|dscn|pict|sam|p)[-_]?\d+",
    r"[-_. \d]+",
    r"(image|img|photo|picture|pic|scan|frame|untitled|unnamed|screenshot|fullsizerender)([-_. ]*\(?\d*\)?)",
)

#: The most patterns of one rule: OpenColorIO's regular expressions fail with 4000.
MOST_PATTERNS = 100

#: Frame numbers at the end of a name: shot.0001.
FRAME_NUMBER = re.compile(r"\.\d{2,}$")


def plate_pattern(name: str) -> str:
    """Return the pattern of a plate's file: its own name, where a frame number at the end stands for any number.

    Parameters
    ----------
    name : str
        The name without folder, for example "shot.0001.jpg", whose pattern is "shot.#.jpg".
    """
    stem, dot, suffix = name.rpartition(".")
    stem = stem.replace("#", "?")
    return FRAME_NUMBER.sub(".#", stem) + dot + suffix if stem else name.replace("#", "?")


def linear_pattern(name: str) -> str:
    """Return the pattern of a linear plate such as "shot.0001_linear.exr": its own name, with any frame number."""
    return re.sub(r"\.\d{2,}(?=_linear\.exr$)", ".#", name.replace("#", "?"))


def linear_patterns(stem: str, names: Sequence[str] = ()) -> tuple[str, ...]:
    """Return the patterns of all linear files of a plate: of these names, and frames such as "clip.0001.exr".

    Parameters
    ----------
    stem : str
        What files of the plate are named after, for example "clip" or "shot.0001".
    names : sequence of str
        The names of its linear files without folder: see `linear_pattern`. For more than `MOST_PATTERNS` of them, one
        pattern stands for all.
    """
    named = map(linear_pattern, names) if len(names) <= MOST_PATTERNS else ["*_linear.exr"]
    return tuple(dict.fromkeys([*named, FRAME_NUMBER.sub("", stem) + ".#.exr"]))


def is_counter_name(name: str) -> bool:
    """Return whether many files of other people are likely to have a name such as "IMG_0001.JPG" or "0001.png"."""
    stem = FRAME_NUMBER.sub("", name.rpartition(".")[0] or name).lower()
    return any(re.fullmatch(counter, stem) for counter in COUNTER_NAMES)


def rule_regex(patterns: Iterable[str]) -> str:
    """Return the regular expression of file names, in a syntax that every host shares.

    Parameters
    ----------
    patterns : iterable of str
        Names with `*` (any characters), `?` (any character) and `#` (a number of any length); none of them matches a
        separator of folders. A pattern holds for full names, in any folder, in upper and lower case (ASCII); with
        folders in it ("shot010/plates/*.jpg"), for the end of a path.
    """
    return r"(.*[/\\])?(" + "|".join(map(_pattern_regex, patterns)) + ")"


def add_file_rule(config: OCIO.Config, name: str, space: str, patterns: Iterable[str]) -> None:
    """Put a file rule before all others of a config; a rule of the same name is replaced.

    Parameters
    ----------
    config : PyOpenColorIO.Config
        The config; it is changed. Without patterns, the rule is only removed. Profile version 1 has no rules.
    name : str
        The rule's name.
    space : str
        The colour space, or role, of the files.
    patterns : iterable of str
        See `rule_regex`.
    """
    remove_file_rules(config, [name])
    patterns = tuple(patterns)
    if not patterns or config.getMajorVersion() < 2:
        return
    rules = config.getFileRules()
    rules.insertRule(0, name, space, rule_regex(patterns))
    config.setFileRules(rules)


def remove_file_rules(config: OCIO.Config, names: Iterable[str]) -> None:
    """Remove the file rules of these names, in upper or lower case, from a config, which is changed."""
    if config.getMajorVersion() < 2:
        return
    unwanted, rules = {name.casefold() for name in names}, config.getFileRules()
    for index in reversed(range(rules.getNumEntries() - 1)):  # the last one is the default, which cannot be removed
        if rules.getName(index).casefold() in unwanted:
            rules.removeRule(index)
    config.setFileRules(rules)


def file_rules(config: OCIO.Config, names: Iterable[str]) -> dict[str, str]:
    """Return the colour space of each file rule of these names, by the rule's regular expression."""
    rules, wanted = config.getFileRules(), {name.casefold() for name in names}
    found = [index for index in range(rules.getNumEntries()) if rules.getName(index).casefold() in wanted]
    return {rules.getRegex(index) or rules.getPattern(index): rules.getColorSpace(index) for index in found}


def _pattern_regex(pattern: str) -> str:
    """Return the regular expression of one pattern."""
    wildcards = {"*": r"[^/\\]*", "?": r"[^/\\]", "#": r"[0-9]+", "/": r"[/\\]", "\\": r"[/\\]"}
    return "".join(wildcards.get(letter) or _letter_regex(letter) for letter in pattern)


def _letter_regex(letter: str) -> str:
    """Return the regular expression of a character: an ASCII letter in both cases, anything else as it is.

    In UTF-8 other letters are several bytes, and std::regex takes each byte in brackets for a character of its own.
    """
    if letter.isascii() and letter.isalpha():
        return f"[{letter.lower()}{letter.upper()}]"
    return "\\" + letter if letter in ".^$+(){}|[]" else letter
