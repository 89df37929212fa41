"""How the E_lin of gamma 2.2 depends on the exposure: ``python -m training.evaluation.gamma_level --data DATA``.

Gamma 2.2 has the same E_est on our curves as in the paper, but an E_lin that is 1.5 times as large on our photographs.
E_lin weighs the error of the inverse response by how often a brightness occurs, so it grows with the exposure. This
command prints by how much, and at which exposure gamma 2.2 has the paper's E_lin.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import linearization_error
from training.evaluation.measure.figures import CODES
from training.evaluation.report import paper
from training.evaluation.report.markdown_tables import rows_of
from training.evaluation.test_sets import TestSet, bundled_test_set, dorf_test_set
from training.synthesis.camera import apply_response

#: Factors on s_crf.
FACTORS = (0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4)

#: Step between the rows and columns of a scene that are measured.
STRIDE = 8

GAMMA = ResponseCurve.gamma(2.2)


@dataclass(frozen=True, eq=False)
class Level:
    """The photographs of every scene (rows) through every response (columns) at one factor on s_crf.

    Parameters
    ----------
    factor : float
        Factor on s_crf.
    errors, unscaled : ndarray, shape (S, N)
        E_lin of gamma 2.2, and the same when the true linear image is not scaled to a peak of 1.
    brightness, irradiance, clipped : ndarray, shape (S, N)
        Mean of the photograph, mean of its true linear image, fraction of samples at the brightest code.
    """

    factor: float
    errors: np.ndarray
    unscaled: np.ndarray
    brightness: np.ndarray
    irradiance: np.ndarray
    clipped: np.ndarray


def gamma_levels(test_set: TestSet, factors: tuple[float, ...] = FACTORS) -> list[Level]:
    """Return what gamma 2.2 does at every factor."""
    light = [file.read().pixels[::STRIDE, ::STRIDE].ravel() for file in test_set.scenes]
    exposures, curves = test_set.exposures(), [ResponseCurve.from_samples(row) for row in test_set.curves]
    levels = []
    for factor in factors:
        figures = np.array(
            [
                [_figures(samples, factor * exposure, curve) for exposure, curve in zip(exposures, curves, strict=True)]
                for samples in light
            ]
        )
        levels.append(Level(factor, *np.moveaxis(figures, -1, 0)))
    return levels


def _figures(light: np.ndarray, exposure: float, curve: ResponseCurve) -> tuple[float, ...]:
    """Return the figures of one photograph, in the order of `Level`."""
    brightness = apply_response(light * np.float32(exposure), curve.brightness)
    counts = np.bincount(np.rint(255 * brightness).astype(int), minlength=256)
    fractions, irradiance = counts / counts.sum(), curve.inverse(CODES)
    error = linearization_error(CODES, curve, GAMMA, counts=counts)
    peak = irradiance[counts > 0].max()
    return error, error * peak, float(fractions @ CODES), float(fractions @ irradiance), float(fractions[255])


def main() -> None:
    """Print the levels, and the scenes at s_crf."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, help="folder with dorf and linear; the bundled lights without")
    data = parser.parse_args().data
    test_set = dorf_test_set(data) if data else bundled_test_set()
    levels = gamma_levels(test_set)
    header = ["x s_crf", "E_lin x 1e-2", "median", "peak not made 1", "mean brightness", "mean irradiance", "clipped"]
    rows = []
    for level in levels:
        means = (level.brightness.mean(), level.irradiance.mean(), level.clipped.mean())
        errors = (100 * level.errors.mean(), 100 * np.median(level.errors), 100 * level.unscaled.mean())
        rows.append([f"{level.factor:g}", *(f"{error:.2f}" for error in errors), *(f"{mean:.3f}" for mean in means)])
    print(rows_of(header, rows))
    mean_errors = [100 * level.errors.mean() for level in levels]
    factor = np.exp(np.interp(paper.GAMMA.linearization, mean_errors, np.log([level.factor for level in levels])))
    print(f"the paper's {paper.GAMMA.linearization} would be reached at {factor:.2f} x s_crf\n")
    plain = next(level for level in levels if level.factor == 1)
    scenes = [
        [file.name, file.kind, f"{100 * errors.mean():.2f}", f"{irradiance.mean():.3f}"]
        for file, errors, irradiance in zip(test_set.scenes, plain.errors, plain.irradiance, strict=True)
    ]
    print(rows_of(["scene at s_crf", "kind", "E_lin x 1e-2", "mean irradiance"], scenes))


if __name__ == "__main__":
    main()
