"""Names for arrays and callbacks; dataclasses that compare arrays or check fields; values made plain; the cores."""

import dataclasses
import math
import numbers
import os
import sys
from collections.abc import Callable, Mapping
from enum import Enum
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, ClassVar, Protocol, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from crfnet_core.errors import CRFNetError, is_file_name

Float32Array = NDArray[np.float32]  # pixels, statistics, and what the network computes with
Float64Array = NDArray[np.float64]  # responses, weights, and what is measured
Uint8Array = NDArray[np.uint8]  # code values of 8 bits
Int16Array = NDArray[np.int16]  # the same, where differences of them are taken
BoolArray = NDArray[np.bool_]
IndexArray = NDArray[np.intp]  # positions in an array

LARGEST = sys.float_info.max  # the largest finite number


class Pixels(Protocol):
    """Pixels that are cut and sampled, shape (H, W, 3), float32 in [0, 1]: an array of them, or a `Photo`."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Rows, columns and channels."""

    def __getitem__(self, index: Any, /) -> Float32Array:
        """Return some of them, for an index of rows and columns."""


Progress = Callable[[int, int], None]  # called with (done, total) after every step; if it raises, the work stops


def show_progress(progress: Progress | None, done: int, total: int) -> None:
    """Call a progress callback, if there is one."""
    if progress is not None:
        progress(done, total)


def counted_from(progress: Progress | None, start: int, total: int) -> Progress | None:
    """Return a callback for a part of the work, which counts what was before it as done."""
    return None if progress is None else lambda done, _total: progress(start + done, total)


def cores() -> int:
    """Return the number of cores that this process may use, which may be fewer than the machine has."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class EqualByFields:
    """Base of dataclasses with arrays, not hashed: equal if all fields are, arrays by elements, and NaN to NaN."""

    __dataclass_fields__: ClassVar[dict[str, dataclasses.Field[Any]]]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, type(self)):
            return NotImplemented
        return all(_same(getattr(self, each.name), getattr(other, each.name)) for each in dataclasses.fields(self))


class CheckedFields:
    """Base of dataclasses of options: raises CRFNetError for one of another type, or out of the bounds in its type."""

    __dataclass_fields__: ClassVar[dict[str, dataclasses.Field[Any]]]

    def __post_init__(self) -> None:
        hints = get_type_hints(type(self), include_extras=True)
        for each in dataclasses.fields(self):
            object.__setattr__(self, each.name, checked_option(each.name, getattr(self, each.name), hints[each.name]))


def checked_option(name: str, value: Any, kind: Any) -> Any:
    """Return an option as a value of the type in an annotation, as `typed_value`; raise CRFNetError."""
    try:
        return typed_value(value, kind)
    except (TypeError, ValueError) as problem:
        raise CRFNetError("bad_option", name=name, problem=problem) from None


def plain_values(value: Any) -> Any:
    """Return a value as plain dicts, lists, texts and numbers; NaN, which JSON does not have, as None."""
    if isinstance(value, Mapping):
        return {plain_values(name): plain_values(entry) for name, entry in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return plain_values(value.tolist())
    if isinstance(value, list | tuple):
        return [plain_values(entry) for entry in value]
    if isinstance(value, Enum):
        return value.value
    return None if isinstance(value, float) and math.isnan(value) else value


def typed_value(value: Any, kind: Any) -> Any:
    """Return a plain value, as of a document, as a value of the type in an annotation; raise TypeError or ValueError.

    Of a dataclass, entries that are not fields are left out. Numbers are finite and not negative, unless an annotation
    such as `Annotated[int, (1, 9)]` states other bounds; `Annotated[str, ("a", "b")]` states all texts. A text may
    stand for a path, and a scalar of NumPy for its value; a dict is not taken for `CheckedFields`.
    """
    origin, arguments = get_origin(kind), get_args(kind)
    value = value.item() if isinstance(value, np.generic) else value
    if origin in (UnionType, Union):
        return typed_value(value, type(value) if type(value) in arguments else arguments[0])
    if origin is tuple:
        return tuple(typed_value(each, arguments[0]) for each in typed_value(value, list | tuple))
    if origin is Annotated and arguments[0] is str:
        if not isinstance(value, str) or value not in arguments[1]:
            raise ValueError(f"{value!a:.40} is none of {', '.join(arguments[1])}")
        return value
    if origin is Annotated:
        return number_of(value, arguments[0], least=arguments[1][0], most=arguments[1][1])
    kind = origin or kind
    if kind in (int, float):
        return number_of(value, kind, least=0)
    if kind is Path and isinstance(value, str | os.PathLike):
        if not is_file_name(value):
            raise ValueError(f"{value!a:.40} cannot be the name of a file")
        return Path(value)
    if hasattr(kind, "__dataclass_fields__") and isinstance(value, dict) and not issubclass(kind, CheckedFields):
        hints = get_type_hints(kind, include_extras=True)
        return kind(**{name: typed_value(value[name], hint) for name, hint in hints.items() if name in value})
    if issubclass(kind, Enum):
        return kind(typed_value(value, str))
    if not isinstance(value, kind):
        raise ValueError(f"{value!a:.40} is not a {kind.__name__}")
    return value


def number_of(value: Any, kind: Any = float, *, least: float = -LARGEST, most: float = LARGEST) -> Any:
    """Return what `is_number` takes as a float or an int; raise ValueError for anything else."""
    if not is_number(value, kind, least=least, most=most):
        raise ValueError(f"{value!a:.20} is not a {'whole ' * (kind is int)}number from {least:g} to {most:g}")
    return kind(value)


def is_number(value: Any, kind: type = float, *, least: float = -LARGEST, most: float = LARGEST) -> bool:
    """Return whether a value is a finite number in bounds, of kind int a whole one; truth values are not numbers."""
    kinds: Any = numbers.Integral if kind is int else numbers.Real
    value = value.item() if isinstance(value, np.generic) else value  # half floats do not compare with `LARGEST`
    return isinstance(value, kinds) and not isinstance(value, bool) and bool(least <= value <= most)


def _same(one: Any, other: Any) -> bool:
    """Return whether two values of a field are equal."""
    if isinstance(one, np.ndarray | float):
        return np.array_equal(one, other, equal_nan=True)
    return bool(one == other)
