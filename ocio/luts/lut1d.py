"""A one-dimensional lookup table: its values, its interpolation in both directions, and the inverse response."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crfnet_core.errors import check_kinds
from crfnet_core.response.curve import BLOCK, ResponseCurve, are_undivided_codes, is_codes, numbers_of
from crfnet_core.types import EqualByFields, Float64Array, is_number

from ..defaults import LUT_LENGTH
from ..errors import LutError

#: Largest number of entries that every format and host accepts.
MAX_LENGTH = 65536

#: Largest slope dE/dB of the lines that continue an inverse response beyond [0, 1].
MAX_END_SLOPE = 8.0

#: Characters kept of a comment; OpenColorIO reads each line of a .spi1d file into a buffer of 4096 bytes.
MAX_COMMENT = 500

#: Largest difference between two values, or the ends of the domain; float32 has room for a thousand times as much.
LARGEST_SPAN = 1e35

#: The bit pattern of the largest subnormal float32.
BELOW_NORMAL = 0x007FFFFF


@dataclass(frozen=True, eq=False)
class Lut1D(EqualByFields):
    """A strictly increasing table, interpolated linearly between its entries, the same for R, G and B.

    All numbers are rounded to float32, the precision of LUT hosts. Written with nine digits they are therefore read
    back bit for bit, and the table increases strictly in every host. Subnormal numbers become 0, because OpenColorIO's
    .spi1d reader refuses them.

    Parameters
    ----------
    values : array_like, shape (N,), 2 <= N <= 65536
        Outputs at N uniform inputs over `domain`; kept as a read-only float64 array of float32 values.
    domain : tuple of float
        The first and the last input.
    comments : tuple of str
        Provenance, one line each; white space is collapsed and lines are cut after 500 characters.

    Raises
    ------
    LutError
        If the values are not finite, do not increase strictly as float32, the domain is not a finite interval, or
        either spans more than `LARGEST_SPAN`.
    """

    values: Float64Array
    domain: tuple[float, float] = (0.0, 1.0)
    comments: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        values = single_precision(self.values)
        low, high = _ends(single_precision(self.domain))
        if values.ndim != 1 or not 2 <= values.size <= MAX_LENGTH:
            raise LutError("lut_shape", most=MAX_LENGTH, shape=values.shape)
        with np.errstate(invalid="ignore"):
            is_faulty = ~np.isfinite(values) | (np.diff(values, prepend=-np.inf) <= 0)
        if is_faulty.any():
            entry = int(np.argmax(is_faulty))
            raise LutError("lut_entry", entry=entry, value=values[entry])
        if max(high - low, values[-1] - values[0]) > LARGEST_SPAN:
            raise LutError("lut_span", most=LARGEST_SPAN)
        values.flags.writeable = False
        object.__setattr__(self, "values", values)
        object.__setattr__(self, "domain", (low, high))
        object.__setattr__(self, "comments", clean_comments(self.comments))

    @property
    def channels(self) -> tuple[Self, ...]:
        """The LUT alone; a LUT with a table for each channel has three."""
        return (self,)

    def apply(self, pixels: ArrayLike) -> NDArray[np.floating]:
        """Return the output for every pixel, by linear interpolation.

        As in OpenColorIO, inputs beyond the domain are clamped to it, and NaN gives the first entry. Half and single
        precision are computed in float32 as in OpenColorIO's CPU renderer: the results differ by one unit in the last
        place at most, on the steepest table. Everything else is computed in float64.

        Parameters
        ----------
        pixels : array_like, any shape but (H, W, 4)
            Inputs in the units of `domain`, without alpha.

        Raises
        ------
        LutError
            If pixels have alpha; if code values are given, which have to be divided: unsigned integers, or integers
            beyond the domain and above 1; or numbers as in `are_undivided_codes`.
        """
        last = max(self.domain[1], 1)
        inputs = _floating(pixels, last=last)
        if are_undivided_codes(inputs, last):
            raise LutError("lut_codes", largest=float(np.fmax.reduce(inputs, axis=None)), last=last)
        outputs = np.empty(inputs.shape, inputs.dtype)
        values = self.values.astype(inputs.dtype)
        source, target, steps = inputs.reshape(-1), outputs.reshape(-1), np.diff(values)
        for start in range(0, source.size, BLOCK):
            block = np.s_[start : start + BLOCK]
            position = self._position(source[block])
            below = np.minimum(position, values.size - 2).astype(np.intp)
            position -= below.astype(position.dtype)
            position *= steps.take(below)
            np.add(values.take(below), position, out=target[block])
        return outputs

    def _position(self, inputs: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return where inputs lie among the entries, from 0 to the last; NaN at 0."""
        kind, last = inputs.dtype.type, self.values.size - 1
        low, high = self.domain
        if self.domain != (0.0, 1.0):
            inputs = inputs * kind(1 / (high - low)) + kind(-low / (high - low))
        position = inputs * kind(last)
        np.fmax(position, 0, out=position)  # unlike np.clip, it gives 0 for NaN
        return np.fmin(position, last, out=position)

    def apply_inverse(self, pixels: ArrayLike) -> NDArray[np.floating]:
        """Return the input that gives every pixel, clamped to the domain; NaN gives the low end of the domain.

        OpenColorIO agrees to 1e-6 if its optimization is lossless. By default, and so in most hosts, it inverts
        through an approximate table, which differs by up to 4e-4 on the steepest curves.

        Parameters
        ----------
        pixels : array_like, any shape
            Outputs, in the units of `values`, light without an upper bound; integers as in `apply`.
        """
        outputs = _floating(pixels, last=max(float(self.values[-1]), 1))
        known = np.where(np.isnan(outputs), -np.inf, outputs).astype(np.float64)
        grid = np.linspace(*self.domain, self.values.size)
        return np.asarray(np.interp(known, self.values, grid), dtype=outputs.dtype)


def inverse_response_lut(
    curve: ResponseCurve,
    *,
    length: int = LUT_LENGTH,
    domain: tuple[float, float] = (0.0, 1.0),
    comments: Sequence[str] = (),
) -> Lut1D:
    """Return the inverse response g, from brightness B to irradiance E, as a LUT.

    A LUT is exact where its entries lie on the codes of the plate, and linear between them. Exact lengths are 255 k + 1
    for 8 bits (256, 4081), 1023 k + 1 for 10 (1024, 4093), 4095 k + 1 for 12, and 65536 for 8 and 16; over a domain of
    (-0.125, 1.125) they are 2550 k + 1 for 8 bits (2551, 5101) and 10230 k + 1 for 10.

    Beyond [0, 1], for super-whites and for noise below black, g continues as a line with its slope over the outermost
    8-bit code. Where a response is flat near an end, its inverse is almost vertical there; that only means that the
    camera clipped. The slope is therefore at most `MAX_END_SLOPE`: brightness 1.125 becomes at most irradiance 2, one
    stop above white.

    Parameters
    ----------
    curve : ResponseCurve
        The response f.
    length : int
        Entries, 2 to 65536.
    domain : tuple of float
        The first and the last brightness; must include [0, 1], whose entries become fewer as it becomes wider.
    comments : sequence of str
        Provenance, one line each.

    Raises
    ------
    LutError
        If the length is out of range, or the domain is not finite or does not include [0, 1].
    """
    check_kinds(curve=(curve, ResponseCurve))
    if not is_number(length, int, least=2, most=MAX_LENGTH):
        raise LutError("lut_length", most=MAX_LENGTH, length=length, usual=LUT_LENGTH)
    low, high = _ends(domain)
    if not (low <= 0 and high >= 1):
        raise LutError("lut_domain_short", low=low, high=high)
    code = 1 / 255
    toe = min(float(curve.inverse(code)) / code, MAX_END_SLOPE)
    shoulder = min((1 - float(curve.inverse(1 - code))) / code, MAX_END_SLOPE)
    brightness = np.linspace(low, high, length)
    inner = np.clip(brightness, 0, 1)
    irradiance = curve.inverse(inner) + toe * np.minimum(brightness, 0) + shoulder * np.maximum(brightness - 1, 0)
    return Lut1D(strictly_increasing(irradiance), (low, high), clean_comments(comments))


def strictly_increasing(values: ArrayLike) -> Float64Array:
    """Return finite, increasing values, shape (N,), rounded to float32, as float64, so that they increase strictly."""
    # The bits of positive float32 numbers, read as integers, are in the order of the numbers: + 1 is the next number.
    bits = single_precision(values).astype(np.float32).view(np.int32).astype(np.int64)
    magnitude = bits & 0x7FFFFFFF
    rank = np.sign(bits) * np.maximum(magnitude - BELOW_NORMAL, 0)
    steps = np.arange(rank.size)
    raised = np.maximum.accumulate(rank - steps) + steps  # at least 1 above the entry before
    raised = np.minimum(raised, rank[-1] - steps[::-1])  # and never above the last entry, which stays
    pattern = np.where(raised == 0, 0, np.abs(raised) + BELOW_NORMAL).astype(np.int32)
    return np.asarray(np.copysign(pattern.view(np.float32), raised), dtype=np.float64)


def clean_comments(comments: Iterable[str]) -> tuple[str, ...]:
    """Return the comments, each fit for one line of any format; empty ones are dropped."""
    if not isinstance(comments, list | tuple) or not all(isinstance(comment, str) for comment in comments):
        raise LutError("lut_comments")
    printable = ("".join(c if c.isprintable() else " " for c in comment) for comment in comments)
    cleaned = (" ".join(comment.split())[:MAX_COMMENT].strip() for comment in printable)
    return tuple(comment for comment in cleaned if comment)


def single_precision(values: ArrayLike) -> Float64Array:
    """Return `values` rounded to float32, as float64; subnormal numbers become 0."""
    with np.errstate(over="ignore"):
        single = numbers_of(values, LutError).astype(np.float64).astype(np.float32)
    return np.where(np.abs(single) < np.finfo(np.float32).tiny, 0, single).astype(np.float64)


def _ends(domain: ArrayLike) -> tuple[float, float]:
    """Return the first and the last input of a domain; refuse one that is not a finite interval."""
    ends = numbers_of(domain, LutError)
    if ends.shape != (2,) or not -np.inf < ends[0] < ends[1] < np.inf:
        raise LutError("lut_domain", domain=domain)
    return float(ends[0]), float(ends[1])


def _floating(pixels: ArrayLike, *, last: float) -> NDArray[np.floating]:
    """Return float32 for half and single precision, float64 for all else; refuse codes beyond `last`, and alpha."""
    numbers = numbers_of(pixels, LutError)
    if numbers.ndim > 2 and numbers.shape[-1] == 4:  # OpenColorIO leaves alpha as it is
        raise LutError("lut_pixels", shape=numbers.shape)
    most = -1 if is_codes(numbers) and last < 255 else last
    if numbers.dtype.kind in "iu" and numbers.size and numbers.max() > most:
        raise LutError("lut_codes", largest=int(numbers.max()), last=last)
    is_single = numbers.dtype.kind == "f" and numbers.dtype.itemsize <= 4
    return numbers.astype(np.float32 if is_single else np.float64, copy=False)
