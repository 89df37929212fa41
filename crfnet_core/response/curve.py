"""The camera response: how relative irradiance E becomes image brightness B."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crfnet_core.errors import CRFNetError, CurveError
from crfnet_core.types import BoolArray, EqualByFields, Float32Array, Float64Array, IndexArray, is_number

SAMPLES = 1024  # samples of a response over irradiance in [0, 1], as in DoRF and EMoR
LEAST_SLOPE = 1e-4  # fraction of the identity mixed into every response, which bounds the slope of the inverse
MOST_BRIGHTNESS = 2.0  # super-whites reach 1.1, and larger numbers are codes that nobody divided
NUMBERS = "fiub"  # kinds of NumPy's numbers: real ones, integers and truth values
BLOCK = 32768  # values that are interpolated at a time, because they fit into a core's cache
CELLS = 16384  # cells of equal width by which `_PiecewiseLinear` finds the segment of a value

#: As many uniform numbers from 0 to 1, read-only: irradiances of a response, or brightnesses of an inverse response.
UNIFORM = np.linspace(0, 1, SAMPLES)
UNIFORM.flags.writeable = False


@dataclass(frozen=True, eq=False)
class ResponseCurve(EqualByFields):
    """A strictly increasing response f with f(0) = 0 and f(1) = 1, linear between its samples.

    Build one with `from_samples`; the constructor only checks. As arrays, a response is `brightness` over
    `irradiance`. Its methods `forward` and `inverse` take numbers and arrays of any shape; single precision stays
    single precision. Curves are equal if their samples are.

    Parameters
    ----------
    brightness : ndarray, float64, shape (1024,)
        f at `SAMPLES` uniform irradiances from 0 to 1; strictly increasing from 0 to 1.

    Raises
    ------
    CurveError
        If the samples are of another shape, not strictly increasing, or do not run from 0 to 1.
    """

    brightness: Float64Array

    def __post_init__(self) -> None:
        brightness = numbers_of(self.brightness, CurveError).astype(np.float64)
        if brightness.shape != (SAMPLES,):
            raise CurveError("curve_shape", samples=SAMPLES, shape=brightness.shape)
        if brightness[0] != 0 or brightness[-1] != 1 or not (np.diff(brightness) > 0).all():
            raise CurveError("curve_not_strict")
        brightness.flags.writeable = False
        object.__setattr__(self, "brightness", brightness)

    def __hash__(self) -> int:
        return hash(self.brightness.tobytes())

    def __reduce__(self) -> tuple[type[ResponseCurve], tuple[Float64Array]]:
        """Return how copies and other processes make the same curve: checked and read-only again, without tables."""
        return type(self), (self.brightness,)

    @classmethod
    def from_samples(cls, samples: ArrayLike) -> ResponseCurve:
        """Return the strictly monotone, normalized response nearest to `samples` (Eq. 26 and 27 of docs/METHOD.md).

        The samples are scaled to run from 0 to 1 and projected on the increasing sequences (`nearest_increasing`):
        a projection on a convex set brings a curve no farther from any member of the set, so this never raises the
        error against a true response. `LEAST_SLOPE` of the identity is then mixed in, which makes it strict.

        Parameters
        ----------
        samples : array_like, shape (N,), N >= 2
            The response at N uniform irradiances from 0 to 1, in any scale; resampled to `SAMPLES` if need be.

        Raises
        ------
        CurveError
            If there are fewer than two finite samples, or the last is not above the first.
        """
        values = numbers_of(samples, CurveError).astype(np.float64)
        if values.ndim != 1 or values.size < 2 or not np.isfinite(values).all():
            raise CurveError("curve_samples")
        if values[-1] <= values[0]:
            raise CurveError("curve_dark")
        if values.size != SAMPLES:
            values = np.interp(UNIFORM, np.linspace(0, 1, values.size), values)
        scaled = np.clip((values - values[0]) / (values[-1] - values[0]), 0, 1)
        strict = (1 - LEAST_SLOPE) * nearest_increasing(scaled) + LEAST_SLOPE * UNIFORM
        return cls((strict - strict[0]) / (strict[-1] - strict[0]))

    @classmethod
    def restored(cls, samples: ArrayLike) -> ResponseCurve:
        """Return the response whose samples a document holds; of rounded ones, the nearest as `from_samples` has it."""
        try:
            return cls(numbers_of(samples, CurveError))
        except CurveError:
            return cls.from_samples(samples)

    @classmethod
    def gamma(cls, exponent: float = 2.2) -> ResponseCurve:
        """Return the power law f(E) = E ** (1 / exponent), the usual guess without an estimate.

        Raises
        ------
        CurveError
            If `exponent` is not a number above 0.
        """
        if not is_number(exponent, least=0) or not exponent:
            raise CurveError("curve_exponent", exponent=exponent)
        return cls.from_samples(UNIFORM ** (1 / float(exponent)))

    @property
    def irradiance(self) -> Float64Array:
        """The irradiances of the samples, uniform from 0 to 1: float64, shape (1024,), read-only."""
        return UNIFORM

    @overload
    def forward(self, irradiance: float) -> float: ...
    @overload
    def forward(self, irradiance: NDArray[np.float32] | NDArray[np.float16]) -> Float32Array: ...
    @overload
    def forward(self, irradiance: NDArray[Any] | Sequence[Any]) -> Float64Array: ...
    def forward(self, irradiance: ArrayLike) -> Any:
        """Return brightness f(E) in [0, 1]; E is clipped to [0, 1], and NaN stays NaN.

        Parameters
        ----------
        irradiance : float or array_like, any shape
            Relative irradiance E, linear; not changed.

        Returns
        -------
        float or ndarray, of the shape of `irradiance`
            float32 of single and half precision, else float64; computed in double precision.

        Raises
        ------
        CurveError
            If integers above 1 are given: code values, which have to be divided by the largest code.
        """
        return self._forward(irradiance)

    @overload
    def inverse(self, brightness: float) -> float: ...
    @overload
    def inverse(self, brightness: NDArray[np.float32] | NDArray[np.float16]) -> Float32Array: ...
    @overload
    def inverse(self, brightness: NDArray[Any] | Sequence[Any]) -> Float64Array: ...
    def inverse(self, brightness: ArrayLike) -> Any:
        """Return irradiance g(B) in [0, 1]; B is clipped to [0, 1], and NaN stays NaN.

        This is the exact inverse of `forward`. Our LUTs of it have the same values at the codes that they are exact on:
        see `crfnet.luts.lut1d.inverse_response_lut`.

        Parameters
        ----------
        brightness : float or array_like, any shape
            Encoded brightness B, such as `Photo.pixels`; not changed.

        Returns
        -------
        float or ndarray, of the shape of `brightness`
            float32 of single and half precision, else float64; computed in double precision.

        Raises
        ------
        CurveError
            If code values are given, which have to be divided by the largest code: integers above 1, arrays of unsigned
            integers, or numbers as in `are_undivided_codes`.
        """
        return self._inverse(brightness)

    @cached_property
    def _forward(self) -> _PiecewiseLinear:
        return _PiecewiseLinear(self.irradiance, self.brightness)

    @cached_property
    def _inverse(self) -> _PiecewiseLinear:
        return _PiecewiseLinear(self.brightness, self.irradiance, is_of_brightness=True)


def are_undivided_codes(values: NDArray[np.floating], last: float = 1.0) -> bool:
    """Return whether numbers are codes: most exceed `MOST_BRIGHTNESS` times `last`, or some do and all are whole.

    Some exceed it in sound pictures, too, such as at edges of colors that were divided by alpha.
    """
    above = np.count_nonzero(values > MOST_BRIGHTNESS * last)
    return bool(2 * above > values.size or (above and ((values == np.rint(values)) | np.isnan(values)).all()))


def numbers_of(values: ArrayLike, error: type[CRFNetError]) -> NDArray[Any]:
    """Return values as an array; raise `error` if they are not numbers, not all there, or in rows of unequal length."""
    try:
        numbers = np.asarray(values)
    except ValueError:
        raise error("not_numbers", kind="rows of unequal length") from None
    except (RuntimeError, TypeError) as problem:  # tensors of PyTorch with a gradient, or on another device
        raise error("not_numbers", kind=f"a {type(values).__name__}") from problem
    if numbers.dtype.kind not in NUMBERS or np.ma.is_masked(values):
        raise error("not_numbers", kind="masked values" if np.ma.is_masked(values) else str(numbers.dtype))
    return numbers


def is_codes(values: NDArray[Any]) -> bool:
    """Return whether an array has the type of code values, even if all of them are 0 or 1, as in a black frame."""
    return values.dtype.kind == "u" and values.dtype.itemsize <= 2 and values.ndim > 0


class _PiecewiseLinear:
    """A function that is linear between knots from 0 to 1, and evaluated fast on large arrays.

    It has the values of `numpy.interp`, which searches the segment of each value by bisection and takes five times as
    long on a photograph. Here a table of cells holds the segment or the one before it, unless knots lie closer.
    """

    def __init__(self, knots: Float64Array, values: Float64Array, *, is_of_brightness: bool = False) -> None:
        self._knots, self._values, self._is_of_brightness = knots, values, is_of_brightness

    def __call__(self, arguments: ArrayLike) -> Any:
        """Return the function at each argument, clipped to [0, 1], in the shape of `arguments`."""
        values = numbers_of(arguments, CurveError)
        if self._is_of_brightness and are_undivided_codes(values):
            raise CurveError("brightness_codes", found=float(np.fmax.reduce(values, axis=None)))
        if values.dtype.kind in "iu" and values.size and (is_codes(values) or values.max() > 1):
            raise CurveError("brightness_codes", found=int(values.max()))
        kind = np.float32 if values.dtype.kind == "f" and values.dtype.itemsize <= 4 else np.float64
        if values.size <= BLOCK:
            return kind(np.interp(values.astype(np.float64), self._knots, self._values))
        result = np.empty(values.shape, kind)
        source, target = values.reshape(-1), result.reshape(-1)
        for start in range(0, values.size, BLOCK):
            block = np.s_[start : start + BLOCK]
            target[block] = self._evaluated(source[block].astype(np.float64))
        return result

    @cached_property
    def _table(self) -> tuple[IndexArray, BoolArray, Float64Array, Float64Array]:
        """Of each cell its first knot, and whether it holds several; of each knot the next one, and the slope to it."""
        first = np.searchsorted(self._knots, np.arange(CELLS + 1) / CELLS, side="right") - 1  # the last cell is 1 alone
        slopes = np.diff(self._values) / np.diff(self._knots)
        is_crowded = np.diff(first, append=first[-1]) > 1
        return first, is_crowded, np.append(self._knots[1:], np.inf), np.append(slopes, 0)

    def _evaluated(self, arguments: Float64Array) -> Float64Array:
        """Return the function at a row of arguments, which is overwritten."""
        first, is_crowded, following, slopes = self._table
        np.clip(arguments, 0, 1, out=arguments)
        with np.errstate(invalid="ignore"):  # NaN is a number below all cells, and mode="clip" makes 0 of it
            cells = (arguments * CELLS).astype(np.intp)
        if is_crowded.take(cells, mode="clip").any():
            return np.interp(arguments, self._knots, self._values)
        index = first.take(cells, mode="clip")
        index += arguments >= following.take(index)
        result = arguments - self._knots.take(index)
        result *= slopes.take(index)
        result += self._values.take(index)
        return result


def nearest_increasing(samples: ArrayLike) -> Float64Array:
    """Return the non-decreasing sequence nearest to `samples` in L2, shape (N,): pool adjacent violators (Eq. 26).

    Source: Ayer et al., "An empirical distribution function for sampling with incomplete information", 1955.
    """
    means: list[float] = []
    counts: list[int] = []
    for value in np.asarray(samples, dtype=np.float64).tolist():
        mean, count = value, 1
        while means and means[-1] > mean:
            before, size = means.pop(), counts.pop()
            mean, count = (mean * count + before * size) / (count + size), count + size
        means.append(mean)
        counts.append(count)
    return np.repeat(means, counts)
