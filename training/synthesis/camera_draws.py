"""Random cameras that develop: what each kind of file went through, with the shares and ranges of real ones."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Self

import numpy as np
from PIL import Image

from crfnet_core.statistics.windows import WINDOW_SIZE
from training.synthesis.development import Development, Export, ToneMapping
from training.synthesis.picture import Finish, Jpeg, Sharpening
from training.synthesis.sensor import Demosaicing, Sensor

#: Windows of a training photograph.
WINDOWS = 4


class FrameKind(StrEnum):
    """How a window comes from the camera's frame.

    `PLAIN` is `training.synthesis.camera.Capture`; a window of a `NATIVE` frame has all its samples; a `SAMPLED` one is
    point-sampled, as the product does with large photographs; a `SCALED` one was made smaller after it was encoded.
    """

    PLAIN = "plain"
    NATIVE = "native"
    SAMPLED = "sampled"
    SCALED = "scaled"


#: Fractions of the training photographs of each kind.
KIND_FRACTIONS = {FrameKind.PLAIN: 0.7, FrameKind.NATIVE: 0.14, FrameKind.SAMPLED: 0.04, FrameKind.SCALED: 0.12}


@dataclass(frozen=True)
class Frames:
    """The frames that the windows of a photograph come from: how many, and the samples along each of their sides."""

    count: int
    side: int

    @classmethod
    def draw(cls, kind: FrameKind, rng: np.random.Generator) -> Self:
        """Return the frames of a kind. Where they are point-sampled, several windows come from each."""
        if kind is FrameKind.SAMPLED:
            step = int(rng.choice((2, 3), p=(0.9, 0.1)))
            return cls(2 if step == 2 else 1, WINDOW_SIZE * step)
        if kind is FrameKind.SCALED:
            return cls(WINDOWS, round(WINDOW_SIZE * rng.choice((1.5, 2.0), p=(0.9, 0.1))))
        return cls(WINDOWS, WINDOW_SIZE)


#: Fraction of the lenses that blur, by kind of frame, and the range of the standard deviation in samples of the frame.
BLURRED = {FrameKind.NATIVE: 0.8, FrameKind.SAMPLED: 0.3, FrameKind.SCALED: 0.4}
LENS_BLUR = {FrameKind.NATIVE: (0.3, 1.1), FrameKind.SAMPLED: (0.4, 0.7), FrameKind.SCALED: (0.4, 0.7)}


def draw_development(kind: FrameKind, rng: np.random.Generator) -> Development:
    """Return the development of a random camera for a kind of frame other than `PLAIN`."""
    return Development(
        lens_blur=rng.uniform(*LENS_BLUR[kind]) if rng.random() < BLURRED[kind] else 0.0,
        glare=rng.uniform(0, 0.05),
        sensor=_sensor(rng, noise=1.5 if kind is FrameKind.SAMPLED else 1),
        tone_mapping=ToneMapping(rng.uniform(0.05, 0.35), rng.uniform(0.03, 0.15)) if rng.random() < 0.2 else None,
        keeps_hue=bool(rng.random() < 0.3),
        finish=_finish(rng),
        jpeg=_jpeg(rng),
        export=_export(rng) if kind is FrameKind.SCALED else None,
        scatter=int(rng.integers(2)) if kind is FrameKind.SAMPLED else 0,
    )


def _sensor(rng: np.random.Generator, *, noise: float) -> Sensor:
    """Return a sensor between base and high sensitivity, with `noise` times the variance."""
    shot_noise = noise * 10 ** rng.uniform(-5.2, -3.7)
    return Sensor(
        shot_noise=shot_noise,
        read_noise=float(np.sqrt(shot_noise)) * rng.uniform(0.01, 0.04),
        gains=(rng.uniform(1, 2.4), 1.0, rng.uniform(1, 2.4)),
        white=rng.uniform(1, 1.3),
        clips_apart=bool(rng.random() < 0.3),
        crosstalk=rng.uniform(0, 0.4),
        saturation=float(np.exp(rng.normal(-0.15, 0.3))),
        demosaicing=rng.choice((Demosaicing.BILINEAR, Demosaicing.GRADIENT_CORRECTED), p=(0.25, 0.75)),
    )


def _finish(rng: np.random.Generator) -> Finish:
    """Return the steps of a camera on the encoded picture."""
    return Finish(
        chroma_blur=int(rng.choice((0, 3, 5))),
        luma_smoothing=rng.uniform(1, 5) / 255 if rng.random() < 0.8 else 0.0,
        chroma_gain=rng.uniform(0.9, 1.35),
        sharpening=_sharpening(rng) if rng.random() < 0.85 else None,
    )


def _sharpening(rng: np.random.Generator) -> Sharpening:
    return Sharpening(
        amount=rng.uniform(0.2, 1.5),
        radius=rng.uniform(0.6, 2),
        limit=rng.uniform(8, 50) / 255,
        threshold=rng.uniform(0, 2) / 255,
    )


def _jpeg(rng: np.random.Generator) -> Jpeg:
    """Return the compression of a camera: IJG qualities of about 90 to 98, some with flatter tables."""
    return Jpeg(
        scale=0.04 * 10 ** rng.uniform(0, 0.8),
        flatness=rng.uniform(0, 0.8) if rng.random() < 0.5 else 0.0,
        subsampling=int(rng.choice((0, 1, 2), p=(0.15, 0.5, 0.35))),
    )


def _export(rng: np.random.Generator) -> Export:
    """Return a scaling for the web, some with sharpening, and a JPEG of IJG quality 75 to 98."""
    filters = (Image.Resampling.BOX, Image.Resampling.BICUBIC, Image.Resampling.LANCZOS, Image.Resampling.BILINEAR)
    return Export(
        resample=filters[rng.integers(len(filters))],
        finish=Finish(sharpening=_sharpening(rng)) if rng.random() < 0.4 else Finish(),
        jpeg=Jpeg(0.04 * 10 ** rng.uniform(0, 1.1), 0.0, int(rng.choice((0, 2)))),
    )
