"""File rules of a config: the files of a plate, by their full names in upper or lower case."""

import re
import unicodedata
from collections import defaultdict
from collections.abc import Iterable, Sequence
from itertools import product
from typing import NamedTuple

import PyOpenColorIO as OCIO

from ..plates.frame_pattern import literal

#: The family of every plate's color space, which sets its rules apart from others.
FAMILY = "Camera Response"

#: End the names of rules for linear files, and for files without a space of their own. No plate's name holds a colon.
LINEAR, SHARED = ": linear", ": shared"

#: File names, without suffix, that cameras and programs give again and again, in lower case: four characters and a
#: number of four digits or five (JEITA CP-3461, "Design rule for Camera File system", and its followers), a number
#: alone, and the usual names of pictures that nobody has named.
COUNTER_NAMES = (
    r"[a-z0-9_]{3,4}_?\d{4,5}",
    r"img_e?\d{4,5}",
    r"(gopr|gp|gx|gh|dji|mvi|img|dsc|dscf|dscn|pict|sam|p)[-_]?\d+",
    r"[-_. \d]+",
    r"(image|img|photo|picture|pic|scan|frame|untitled|unnamed|screenshot|fullsizerender)([-_. ]*\(?\d*\)?)",
)

#: The most patterns of one rule: OpenColorIO's regular expressions fail with 4000.
MOST_PATTERNS = 100

#: Frame numbers at the end of a name: shot.0001, shot.-0001.
FRAME_NUMBER = re.compile(r"\.-?[0-9]{2,}$")


class FileClaim(NamedTuple):
    """Patterns of files that are to have a color space; if it is "", they get none. `rule` names their file rule."""

    rule: str
    space: str
    patterns: tuple[str, ...]


def plate_pattern(name: str) -> str:
    """Return the pattern of a plate's file name: a frame number at the end stands for any, as in shot.#.jpg."""
    stem, dot, suffix = name.rpartition(".")
    return FRAME_NUMBER.sub(".#", literal(stem)) + dot + literal(suffix)


def linear_patterns(
    stem: str, names: Sequence[str] = (), plates: str = "", *, is_movie: bool = False
) -> tuple[str, ...]:
    """Return the patterns of all linear files of a plate: of these names, and frames such as "clip.0001.exr".

    `stem` is the stem of the plate's files, for example "clip" or "shot.0001"; `plates` is the pattern of a sequence.
    A still has no frames: others' renders are called so.
    """
    named = [re.sub(r"\.-?[0-9]{2,}(?=_linear\.exr$)", ".#", literal(name)) for name in names]
    sequence, *_ = plates.rpartition(".")
    frames = [sequence + ".exr"] if "#" in sequence else []
    frames += [FRAME_NUMBER.sub("", stem) + ".#.exr"] if is_movie or FRAME_NUMBER.search(stem) else []
    return tuple(dict.fromkeys([*named, *frames]))


def example(pattern: str) -> str:
    """Return a name that a pattern stands for."""
    return re.sub(r"\[(#)\]|#", lambda match: match[1] or "0001", pattern)


def is_counter_name(pattern: str) -> bool:
    """Return whether many files of others are likely to have a name such as "IMG_0001.JPG", unlike "IMG_0001.#.exr"."""
    name = example(pattern)
    stem = FRAME_NUMBER.sub("", name.rpartition(".")[0] or name).lower()
    return not pattern.endswith(".#.exr") and any(re.fullmatch(counter, stem) for counter in COUNTER_NAMES)


def rule_regex(patterns: Iterable[str]) -> str:
    """Return the regular expression of file names, in a syntax that every host shares.

    In the patterns, `#` stands for a number of any length, also below 0 behind a dot, and `[#]` for the character
    itself. A pattern holds for full names, in any folder, in upper and lower case.
    """
    return r"(.*[/\\])?(" + "|".join(map(_pattern_regex, patterns)) + ")"


def add_file_rules(config: OCIO.Config, claims: Sequence[FileClaim]) -> tuple[str, ...]:
    """Put file rules of new plates before all others of a config, in place; return the patterns that get none.

    Files that plates, also earlier ones of the config, would lead to different spaces get none of these. Their patterns
    stand in a rule behind all others, which changes nothing: there a third plate of the name finds them.
    """
    rules = config.getFileRules()
    last = rules.getNumEntries() - 1
    earlier = {index: claim for index in range(last, -1, -1) if (claim := _claim(config, rules, index))}
    shared = _shared_patterns([*earlier.values(), *claims])
    losing = {index: claim for index, claim in earlier.items() if claim.space and not shared.isdisjoint(claim.patterns)}
    lost = {each.lower(): each for claim in (*losing.values(), *claims) for each in claim.patterns if each in shared}
    if claims:  # a rule of one plate is enough
        _insert(rules, last, plate_of_rule(claims[0].rule) + SHARED, rules.getColorSpace(last), list(lost.values()))
    for index, claim in losing.items():
        rules.removeRule(index)
        _insert(rules, index, claim.rule, claim.space, [each for each in claim.patterns if each not in shared])
    for claim in claims:
        _insert(rules, 0, claim.rule, claim.space, [each for each in claim.patterns if each not in shared])
    config.setFileRules(rules)
    return tuple(lost.values())


def plate_of_rule(rule: str) -> str:
    """Return the color space of the plate that a rule of this name belongs to."""
    return rule.partition(": ")[0]


def plate_rules(config: OCIO.Config, space: str) -> dict[str, str]:
    """Return the color space of each file rule of a plate that changes it, by the rule's regular expression."""
    rules = config.getFileRules()
    names = {index: rules.getName(index) for index in range(rules.getNumEntries())}
    own = [index for index, name in names.items() if plate_of_rule(name) == space and SHARED not in name]
    return {rules.getRegex(index): rules.getColorSpace(index) for index in own}


def _insert(rules: OCIO.FileRules, index: int, name: str, space: str, patterns: Sequence[str]) -> None:
    """Put rules for patterns at a place, as many as `MOST_PATTERNS` makes of them."""
    for start in range(0, len(patterns), MOST_PATTERNS):
        part = f": {start // MOST_PATTERNS + 1}" if start else ""
        rules.insertRule(index, name + part, space, rule_regex(patterns[start : start + MOST_PATTERNS]))


def _claim(config: OCIO.Config, rules: OCIO.FileRules, index: int) -> FileClaim | None:
    """Return what a plate's rule claims; None if a rule is another's, or somebody has changed its expression."""
    name, regex = rules.getName(index), rules.getRegex(index)
    plate = config.getColorSpace(plate_of_rule(name))
    if not plate or plate.getFamily() != FAMILY:
        return None
    patterns = _patterns(regex)
    if rule_regex(patterns).replace("-?", "") != regex.replace("-?", ""):  # earlier, no frames were below 0
        return None
    return FileClaim(name, "" if SHARED in name else rules.getColorSpace(index), patterns)


def _patterns(regex: str) -> tuple[str, ...]:
    """Return the patterns of an expression of `rule_regex`, in lower case."""

    def pattern(match: re.Match[str]) -> str:
        if match[0].endswith("]+"):
            return "#"
        return "/" if match[0] == "|" else literal(match[match.lastindex or 0])  # no name holds a "/"

    tokens = r"(?:-\?)?\[0-9\]\+|\[(.).\]|\((.)\|[^)]*\)|\\(.)|."
    return tuple(re.sub(tokens, pattern, regex[len(rule_regex([])) - 1 : -1], flags=re.DOTALL).split("/"))


def _shared_patterns(claims: Iterable[FileClaim]) -> set[str]:
    """Return the patterns of claims that get no space, or have a file in common with one of another space."""
    alike = defaultdict[str, list[tuple[str, str]]](list)  # but for numbers
    for pattern, space in ((pattern, claim.space) for claim in claims for pattern in claim.patterns):
        alike[re.sub("[-0-9#]", "", _folded(pattern))].append((pattern, space))
    return {
        pattern
        for group in alike.values()
        for pattern, space in group
        if not space or any(other != space and _have_common(pattern, another) for another, other in group)
    }


def _folded(pattern: str) -> str:
    """Return the same text for all names that a rule or a system takes for one; upper() unites the dotless i with i."""
    return unicodedata.normalize("NFC", pattern.upper().casefold())


def _have_common(one: str, other: str) -> bool:
    """Return whether two patterns have a file in common."""
    if "#" not in one + other:
        return _folded(one) == _folded(other)
    parts = [re.split(r"(?<!\[)#|#(?!\])", pattern) for pattern in (one, other)]  # at numbers, not at [#]
    mixed = (f"{head[0]}#{tail[-1]}" for head, tail in product(parts, parts))
    regexes = [rule_regex([pattern]) for pattern in (one, other)]
    return any(all(re.fullmatch(regex, example(name)) for regex in regexes) for name in (one, other, *mixed))


def _pattern_regex(pattern: str) -> str:
    """Return the regular expression of one pattern."""
    special = {"#": r"[0-9]+", ".#": r"\.-?[0-9]+", "[#]": "#"}
    parts = re.findall(r"\[#\]|\.#|.", pattern, re.DOTALL)
    return "".join(special.get(part) or _letter_regex(part) for part in parts)


def _letter_regex(letter: str) -> str:
    """Return the regular expression of a character: a letter in both cases, anything else as it is.

    In UTF-8 other letters than ASCII are several bytes, which std::regex takes for separate characters in brackets.
    """
    if letter.isascii() and letter.isalpha():
        return f"[{letter.lower()}{letter.upper()}]"
    if letter.lower() != letter.upper():
        return f"({'|'.join(dict.fromkeys((letter, letter.lower(), letter.upper())))})"
    return "\\" + letter if letter in ".^$+(){}|[]*?\\" else letter
