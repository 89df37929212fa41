"""The errors and notices of this project: a code, and the facts of the case.

The code that finds a problem states both and no sentence: ``raise PhotoError("too_small", path=path, width=64)``. Each
sentence stands once, in `crfnet_core.messages`, and `str` fills it in. An interface that can say more, such as which of
its options helps, looks the code up in its own table.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from crfnet_core.messages import SENTENCES


class CRFNetError(Exception):
    """Base of every error that a caller can fix: bad input, a bad file, a bad option.

    Parameters
    ----------
    code : str
        Names the problem: a key of `sentences`.
    **facts : object
        The names in the sentence, such as the path, the value found and the value needed.
    """

    #: The sentences of all codes; a package that adds codes overrides it with its own table.
    sentences: Mapping[str, str] = SENTENCES

    def __init__(self, code: str, /, **facts: object) -> None:
        super().__init__(code)
        self.code = code
        self.facts = facts

    def __str__(self) -> str:
        """Return the sentence of the code, on one line."""
        return filled(self.sentences.get(self.code, self.code), self.facts)


@dataclass(frozen=True, eq=False)
class Notice:
    """A finding that is not an error, such as a reason to doubt an estimate: a code and its facts, as of `CRFNetError`.

    Two notices are equal if their sentences are: a notice that was read from a document has its sentence alone.
    """

    code: str
    facts: Mapping[str, object] = field(default_factory=dict)

    @classmethod
    def from_text(cls, text: str) -> Notice:
        """Return the notice of a sentence whose code is not known."""
        return cls("as_written", {"text": text})

    def __str__(self) -> str:
        """Return the sentence of the code, on one line."""
        return filled(SENTENCES.get(self.code, self.code), self.facts)

    def __eq__(self, other: object) -> bool:
        return str(self) == str(other) if isinstance(other, Notice) else NotImplemented

    def __hash__(self) -> int:
        return hash(str(self))


def filled(sentence: str, facts: Mapping[str, object]) -> str:
    """Return a sentence with the facts in its braces; line breaks and control characters of foreign texts are gone."""
    if not facts:
        return sentence
    plain = {name: fact if isinstance(fact, int | float) else one_line(str(fact)) for name, fact in facts.items()}
    return sentence.format(**plain)


class PhotoError(CRFNetError):
    """A photograph that cannot be read or analyzed."""


class ModelError(CRFNetError):
    """A model folder that is incomplete, altered or of another kind than expected."""


class PriorError(CRFNetError):
    """A prior that is absent or describes no shares of families."""


class CurveError(CRFNetError):
    """Samples that describe no camera response."""


class EstimateError(CRFNetError):
    """A document that holds no estimate, or one of a later version."""


class CalibrationError(CRFNetError):
    """An exposure stack that cannot be read as one, or that no camera response explains."""


class CameraError(CRFNetError):
    """A stored camera that is absent, damaged or cannot be written."""


def check_kinds(**arguments: tuple[object, Any]) -> None:
    """Raise CRFNetError for an argument that is not of its kind, or a path that cannot be the name of a file."""
    for name, (value, kind) in arguments.items():
        if not isinstance(value, kind):
            needed = getattr(kind, "__name__", kind)
            raise CRFNetError("argument_kind", name=name, found=type(value).__name__, needed=needed)
        is_path = isinstance(Path(), kind) and isinstance(value, str | Path)
        if is_path and not is_file_name(value):
            raise CRFNetError("argument_kind", name=name, found="text that no file's name can be", needed="file's name")


def is_file_name(path: str | os.PathLike[str]) -> bool:
    """Return whether the system takes a path as the name of a file."""
    try:
        return b"\0" not in os.fsencode(path)
    except UnicodeEncodeError:  # half of a surrogate pair
        return False


def beside_limits(value: float, *limits: float) -> str:
    """Return a number with two decimals, or up to six where fewer would hide on which side of a limit it lies."""
    for decimals in range(2, 7):
        shown = round(value, decimals)
        if all((value > limit, value < limit) == (shown > limit, shown < limit) for limit in limits):
            break
    return f"{value:.{decimals}f}"


def one_line(problem: BaseException | str) -> str:
    """Return an error's text on one line; control characters, as a damaged file may bring, become question marks."""
    text = " ".join(str(problem).split())
    return "".join(character if character.isprintable() else "?" for character in text)
