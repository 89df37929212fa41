"""A 1D LUT for each channel, as programs write that measure R, G and B apart."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crfnet_core.response.curve import numbers_of
from crfnet_core.types import Float64Array

from ..errors import LutError
from .lut1d import Lut1D, clean_comments


@dataclass(frozen=True)
class RgbLut1D:
    """Three tables of one length and one domain, else a LutError, for R, G and B; and provenance, a line a comment."""

    channels: tuple[Lut1D, ...]
    comments: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        shapes = {(channel.values.size, channel.domain) for channel in self.channels}
        if len(self.channels) != 3 or len(shapes) != 1:
            raise LutError("lut_tables_differ")
        object.__setattr__(self, "comments", clean_comments(self.comments))
        object.__setattr__(self, "channels", tuple(replace(channel, comments=()) for channel in self.channels))

    @property
    def domain(self) -> tuple[float, float]:
        """The first and the last input."""
        return self.channels[0].domain

    @property
    def values(self) -> Float64Array:
        """The outputs, shape (N, 3)."""
        return np.stack([channel.values for channel in self.channels], axis=1)

    def apply(self, pixels: ArrayLike) -> NDArray[np.floating]:
        """Return the output of each channel, shape (..., 3), for pixels of that shape: see `Lut1D.apply`."""
        inputs = numbers_of(pixels, LutError)
        if inputs.shape[-1:] != (3,):
            raise LutError("lut_pixels", shape=inputs.shape)
        return np.stack([lut.apply(inputs[..., index]) for index, lut in enumerate(self.channels)], axis=-1)


#: A LUT for all channels, or one for each.
AnyLut: TypeAlias = Lut1D | RgbLut1D


def lut_of_channels(tables: Sequence[Lut1D]) -> AnyLut:
    """Return the LUT of one table for all channels, or of three for R, G and B."""
    return tables[0] if len(tables) == 1 else RgbLut1D(tuple(tables))


def lut_of_columns(table: Float64Array, domain: tuple[float, float], comments: Sequence[str]) -> AnyLut:
    """Return the LUT of a table, shape (N, 3): one for all channels if its columns are equal, else three."""
    if (table == table[:, :1]).all():
        return Lut1D(table[:, 0], domain, tuple(comments))
    return RgbLut1D(tuple(Lut1D(column, domain) for column in table.T), tuple(comments))


def lut_identity(lut: AnyLut) -> str:
    """Return a name that depends on nothing but the tables and their domain: a part of their SHA-256."""
    content = np.array([*lut.domain, *lut.values.ravel()], dtype="<f4").tobytes()
    return f"crfnet-{hashlib.sha256(content).hexdigest()[:32]}"


def table_rows(lut: AnyLut, *, columns: int) -> list[str]:
    """Return the rows of a table with nine digits, which keep float32 values; a single value fills all columns."""
    tables = np.stack([channel.values for channel in lut.channels], axis=1)  # (N, 1) or (N, 3)
    table = np.broadcast_to(tables, (len(tables), columns))
    return [" ".join(f"{value:.9g}" for value in row) for row in table.tolist()]
