"""File rules of a config: the files of a plate, by their full names in upper or lower case."""

import re
from collections.abc import Iterable, Sequence
from itertools import zip_longest

import PyOpenColorIO as OCIO

from ..plates.frame_pattern import literal

#: The family of every plate's color space, which sets its rules apart from others.
FAMILY = "Camera Response"

#: Ends the name of the rule for linear plates, after the name of the plate's color space.
LINEAR_SUFFIX = " linear"

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

#: Matches a number of any length in the regular expressions of rules.
ANY_NUMBER = r"(?:-\?)?\[0-9\]\+"


def plate_pattern(name: str) -> str:
    """Return the pattern of a plate's file name: a frame number at the end stands for any, as in shot.#.jpg."""
    stem, dot, suffix = name.rpartition(".")
    return FRAME_NUMBER.sub(".#", literal(stem)) + dot + literal(suffix)


def linear_patterns(
    stem: str, names: Sequence[str] = (), plates: str = "", *, is_movie: bool = False
) -> tuple[str, ...]:
    """Return the patterns of all linear files of a plate: of these names, and frames such as "clip.0001.exr".

    `stem` is the stem of the plate's files, for example "clip" or "shot.0001"; `plates` is the pattern of a sequence.
    One pattern stands for more than `MOST_PATTERNS` names. A still has no frames: others' renders are called so.
    """
    named = [re.sub(r"\.-?[0-9]{2,}(?=_linear\.exr$)", ".#", literal(name)) for name in names]
    if len(names) > MOST_PATTERNS:
        named = ["*_linear.exr"]
    frames = [plates.rpartition(".")[0] + ".exr"] if "#" in plates else []
    frames += [FRAME_NUMBER.sub("", stem) + ".#.exr"] if is_movie or FRAME_NUMBER.search(stem) else []
    return tuple(dict.fromkeys([*named, *frames]))


def example(pattern: str) -> str:
    """Return a name that a pattern stands for."""
    return re.sub(r"[*#]", "0001", pattern)


def is_counter_name(pattern: str) -> bool:
    """Return whether many files of others are likely to have a name such as "IMG_0001.JPG", unlike "IMG_0001.#.exr"."""
    if pattern.endswith(".#.exr"):
        return False
    name = example(pattern)
    stem = FRAME_NUMBER.sub("", name.rpartition(".")[0] or name).lower()
    return any(re.fullmatch(counter, stem) for counter in COUNTER_NAMES)


def rule_regex(patterns: Iterable[str]) -> str:
    """Return the regular expression of file names, in a syntax that every host shares.

    In the patterns, `*` stands for any characters, `?` for any character, `#` for a number of any length, also below 0
    behind a dot, and `[#]` for the character itself; none of them matches a separator of folders. A pattern holds for
    full names, in any folder, in upper and lower case.
    """
    return r"(.*[/\\])?(" + "|".join(map(_pattern_regex, patterns)) + ")"


def add_file_rule(config: OCIO.Config, name: str, space: str, patterns: Sequence[str]) -> bool:
    """Put the file rule `name` of a plate before all others of a config, in place; return whether it leads to `space`.

    Where rules of other plates lead one of the files to another space, none gets the file: all these rules then stand
    behind all others and change nothing; there a third plate of the name finds them.
    """
    rules = config.getFileRules()
    is_shared = [_release(config, rules, pattern, space) for pattern in patterns]
    if any(is_shared):
        _insert_last(rules, name, rule_regex(patterns))
    else:
        rules.insertRule(0, name, space, rule_regex(patterns))
    config.setFileRules(rules)
    return not any(is_shared)


def color_space_of_file(config: OCIO.Config, name: str) -> str:
    """Return the color space, not the role, or the named transform that the rules of a config give to a file."""
    name, _ = config.getColorSpaceFromFilepath(name)
    space = config.getColorSpace(name)
    return str(space.getName() if space else name)


def plate_rules(config: OCIO.Config, space: str) -> dict[str, str]:
    """Return the color space of each file rule of a plate that changes it, by the rule's regular expression."""
    rules, names = config.getFileRules(), (space, space + LINEAR_SUFFIX)
    usual = rules.getColorSpace(rules.getNumEntries() - 1)
    indices = [index for index in range(rules.getNumEntries()) if rules.getName(index) in names]
    spaces = {rules.getRegex(index): rules.getColorSpace(index) for index in indices}
    return {regex: space for regex, space in spaces.items() if space != usual}


def _release(config: OCIO.Config, rules: OCIO.FileRules, pattern: str, space: str) -> bool:
    """Take the files of a pattern from plates whose rules lead them to another space; return whether there are some."""
    same, shared = _same_files(pattern), list[tuple[int, str, str]]()
    for index in range(rules.getNumEntries() - 1):  # the last one is the default
        name, regex = rules.getName(index), rules.getRegex(index)
        if same.search(regex) and _is_of_plate(config, name) and rules.getColorSpace(index) != space:
            shared.append((index, name, regex))
    for index, *_ in reversed(shared):
        rules.removeRule(index)
    for _, name, regex in shared:
        _insert_last(rules, name, regex)
    return bool(shared)


def _insert_last(rules: OCIO.FileRules, name: str, regex: str) -> None:
    """Put a rule behind all others, to the space of any other file."""
    last = rules.getNumEntries() - 1
    rules.insertRule(last, name, rules.getColorSpace(last), regex)


def _same_files(pattern: str) -> re.Pattern[str]:
    """Return what finds names of a pattern, in which any number is a frame, in the regular expression of a rule."""
    parts = re.split(f"({ANY_NUMBER}|[0-9]+)", _pattern_regex(pattern))
    numbers = [f"({ANY_NUMBER}|{part if part.isdigit() else '[0-9]+'})" for part in parts[1::2]]
    text = "".join(re.escape(part) + number for part, number in zip_longest(parts[::2], numbers, fillvalue=""))
    return re.compile(f"[(|]{text}[)|]")


def _is_of_plate(config: OCIO.Config, rule: str) -> bool:
    """Return whether a rule of this name belongs to a plate."""
    plate = config.getColorSpace(rule.removesuffix(LINEAR_SUFFIX))
    return plate is not None and plate.getFamily() == FAMILY


def _pattern_regex(pattern: str) -> str:
    """Return the regular expression of one pattern."""
    wildcards = {"*": r"[^/\\]*", "?": r"[^/\\]", "#": r"[0-9]+", ".#": r"\.-?[0-9]+", "\\": r"[/\\]"}
    parts = re.findall(r"\[[#*?\\]\]|\.#|.", pattern, re.DOTALL)  # [#] is the character itself
    return "".join(wildcards.get(part) or _letter_regex(part.strip("[]") or part) for part in parts)


def _letter_regex(letter: str) -> str:
    """Return the regular expression of a character: a letter in both cases, anything else as it is.

    In UTF-8 other letters than ASCII are several bytes, which std::regex takes for separate characters in brackets.
    """
    if letter.isascii() and letter.isalpha():
        return f"[{letter.lower()}{letter.upper()}]"
    if letter.lower() != letter.upper():
        return f"({'|'.join(dict.fromkeys((letter, letter.lower(), letter.upper())))})"
    return "\\" + letter if letter in ".^$+(){}|[]*?\\" else letter
