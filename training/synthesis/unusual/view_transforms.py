"""Renderings as Blender shows them: the views Filmic and AgX, by formula."""

from dataclasses import dataclass

import numpy as np

from crfnet_core.response.curve import UNIFORM
from crfnet_core.types import Float32Array, Float64Array
from training.synthesis.camera import apply_response
from training.synthesis.unusual.encodings import SRGB, saturated

#: The range of Filmic and AgX in stops, below and above middle gray.
BLACK_STOPS, WHITE_STOPS, GRAY = -10.0, 6.5, 0.18

PIVOT = BLACK_STOPS / (BLACK_STOPS - WHITE_STOPS)  # where middle gray lies between the two
RENDERING_STOPS = (-1.0, 2.0)  # stops by which somebody who renders moves the exposure

#: AgX as in Blender 4: from linear Rec.709 to Rec.2020, inset (E. Chow and T. Sobotka, AgX_LUT_Gen; rows give red,
#: green and blue), and the way back through the outset.
REC2020 = np.array([[0.627404, 0.329283, 0.043313], [0.069097, 0.919541, 0.011362], [0.016391, 0.088013, 0.895595]])
INSET = np.array([[0.856627, 0.095121, 0.048252], [0.137319, 0.761242, 0.101439], [0.111898, 0.076799, 0.811302]])
OUTSET = np.array([[0.899797, 0.087200, 0.013003], [0.111421, 0.875576, 0.013003], [0.111421, 0.087200, 0.801379]])


@dataclass(frozen=True)
class Sigmoid:
    """The contrast curve of a view: stops, scaled to [0, 1], to values in [0, 1].

    A straight line of `slope` through (`PIVOT`, `middle`), bent towards 0 and 1 by x / (1 + x^p)^(1 / p), with the
    powers p = `toe` and p = `shoulder`, and scaled so that it reaches both.
    """

    middle: float
    slope: float
    toe: float
    shoulder: float

    def __call__(self, position: Float64Array) -> Float64Array:
        """Return values of positions in [0, 1]."""
        below = self._branch(PIVOT - position, PIVOT, self.middle, self.toe)
        above = self._branch(position - PIVOT, 1 - PIVOT, 1 - self.middle, self.shoulder)
        return self.middle + np.where(position < PIVOT, -below, above)

    def _branch(self, distance: Float64Array, end: float, height: float, power: float) -> Float64Array:
        """Return the rise at a distance from the pivot; at `end` it is `height`."""
        scale = self.slope * end * ((self.slope * end / height) ** power - 1) ** (-1 / power)
        steep = self.slope * np.clip(distance, 0, end) / scale
        return scale * steep / (1 + steep**power) ** (1 / power)


#: The curve of AgX, on values that a power of 2.4 makes linear. Against Blender 4.5 a neutral differs by up to 0.001.
AGX_SIGMOID = Sigmoid(GRAY ** (1 / 2.4), 2.4, 1.5, 1.5)


def filmic_sigmoid(slope: float) -> Sigmoid:
    """Return a contrast curve of Filmic, fitted to Blender 4.5's looks; its values are the encoded picture.

    Slopes: low contrast 1.73, medium (the default) 2.17, high 2.81, very high 3.28; a neutral differs by up to 0.02.
    """
    return Sigmoid(0.5015, slope, float(np.interp(slope, [1.73, 2.17, 2.81, 3.28], [2.08, 2.43, 2.76, 2.91])), 3.0)


def filmic(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return pictures in Blender's Filmic view, of any contrast, without its treatment of saturated highlights."""
    position = scaled_stops(irradiance * np.float32(np.exp2(rng.uniform(*RENDERING_STOPS))))
    return apply_response(position, filmic_sigmoid(rng.uniform(1.73, 3.28))(UNIFORM))


def agx(irradiance: Float32Array, rng: np.random.Generator) -> Float32Array:
    """Return pictures in Blender's AgX view: inset, stops through a sigmoid, outset, sRGB.

    A third has a look of other contrast or saturation. The compensation of negative values is left out: they clip.
    """
    exposed = irradiance * np.float32(np.exp2(rng.uniform(*RENDERING_STOPS)))
    formed = apply_response(scaled_stops(exposed @ (INSET @ REC2020).T.astype(np.float32)), AGX_SIGMOID(UNIFORM) ** 2.4)
    linear = formed @ np.linalg.inv(OUTSET @ REC2020).T.astype(np.float32)
    if rng.random() < 1 / 3:
        linear = np.maximum(saturated(linear, rng.uniform(0.7, 1.5)), 0) ** np.float32(rng.uniform(0.8, 1.4))
    return apply_response(linear, SRGB)


def scaled_stops(light: Float32Array) -> Float32Array:
    """Return stops around middle gray, scaled so that [0, 1] is the range of Filmic and AgX."""
    stops = np.log2(np.maximum(light, np.float32(1e-8)) / np.float32(GRAY))
    return np.clip((stops - BLACK_STOPS) / (WHITE_STOPS - BLACK_STOPS), 0, 1)
