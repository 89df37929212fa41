"""The bank of responses: the answers that an estimate weighs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

import numpy as np

from crfnet_core.posterior.families import UNUSUAL, Family
from crfnet_core.response.curve import SAMPLES, UNIFORM
from crfnet_core.response.emor import EmorBasis
from crfnet_core.response.metrics import FIRST_SHAPE_CODE, LAST_SHAPE_CODE
from crfnet_core.response.transfer_functions import hlg_encode, rec709_encode, srgb_encode
from crfnet_core.types import BoolArray, Float32Array, Float64Array, IndexArray

#: The packaged bank; ``python -m training.data.response_bank`` computes it.
BANK_FILE = Path(__file__).parents[1] / "data" / "responses.npz"

STORED_STEPS = 65535  # brightness is stored in this many steps
LEAST_IRRADIANCE = 2.0**-16  # irradiance at which logarithms are cut off: 2^-16, below the noise of any sensor

#: Positions, of 1024 uniform brightnesses, between which the shape of a response matters: see `metrics.shape_error`.
SHAPE_SAMPLES = slice(
    round(FIRST_SHAPE_CODE / 255 * (SAMPLES - 1)), round(LAST_SHAPE_CODE / 255 * (SAMPLES - 1)) + 1, 4
)

#: Irradiances, of 1024 uniform ones, at which the band is computed.
BAND_SAMPLES = np.linspace(0, SAMPLES - 1, 65).round().astype(int)


@dataclass(frozen=True, eq=False)
class ResponseBank:
    """Responses of every family; before a photograph is seen, all of one family are equally likely."""

    brightness: Float32Array  # (N, 1024): responses at uniform irradiances, non-decreasing from 0 to 1
    families: tuple[Family, ...]  # the family of each

    @classmethod
    @cache
    def plain(cls) -> ResponseBank:
        """Return the responses of pictures without a camera's tone curve: gammas from 1, sRGB, Rec.709 and HLG."""
        encoded = [UNIFORM ** (1 / power) for power in (1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.4)]
        encoded += [encode(UNIFORM) for encode in (srgb_encode, rec709_encode, hlg_encode)]
        return cls(np.stack(encoded).astype(np.float32), (Family.UNEXPLAINED,) * len(encoded))

    @classmethod
    @cache
    def load(cls) -> ResponseBank:
        """Return the packaged bank."""
        with np.load(BANK_FILE) as arrays:
            second_differences, numbers = arrays["second_differences"], arrays["families"]
        differences = np.cumsum(second_differences, axis=1, dtype=np.uint16)
        brightness = np.cumsum(differences, axis=1, dtype=np.uint16) / np.float32(STORED_STEPS)
        members = list(Family)
        return cls(brightness.astype(np.float32), tuple(members[number] for number in numbers))

    @cached_property
    def with_plain(self) -> ResponseBank:
        """The same responses, and after them the plain ones."""
        plain = self.plain()
        return ResponseBank(np.concatenate([self.brightness, plain.brightness]), self.families + plain.families)

    def members(self, family: Family) -> BoolArray:
        """Return which responses belong to a family, bool (N,)."""
        return self._members[family]

    @cached_property
    def _members(self) -> dict[Family, BoolArray]:
        """Which responses belong to each family."""
        return {family: np.array([member is family for member in self.families]) for family in Family}

    @cached_property
    def ordinary(self) -> BoolArray:
        """Which responses are of no family in `UNUSUAL`, bool (N,)."""
        return np.array([member not in UNUSUAL for member in self.families])

    @cached_property
    def weights(self) -> Float64Array:
        """EMoR weights of the responses, shape (N, 11)."""
        basis = EmorBasis.load()
        return np.concatenate([basis.project(rows) for rows in np.array_split(self.brightness, 16)])

    @cached_property
    def log_irradiance(self) -> Float32Array:
        """Logarithms, base 2, of the inverse responses at 1024 uniform brightnesses, shape (N, 1024)."""
        rising = np.linspace(0, 1e-6, SAMPLES)  # makes flat parts strictly increasing
        logarithms = np.empty_like(self.brightness)
        for row, into in zip(self.brightness, logarithms, strict=True):
            into[:] = np.log2(np.maximum(np.interp(UNIFORM, (row + rising) / (1 + 1e-6), UNIFORM), LEAST_IRRADIANCE))
        return logarithms

    @cached_property
    def ordered(self) -> tuple[IndexArray, Float64Array]:
        """The order of the responses by brightness at each of `BAND_SAMPLES`, and these brightnesses, (65, N)."""
        values = self.brightness[:, BAND_SAMPLES].T.astype(np.float64)
        order = np.argsort(values, axis=1)
        return order, np.take_along_axis(values, order, axis=1)
