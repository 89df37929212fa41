"""Convert DoRF's own text: ``python -m training.data.dorf dorfCurves.txt DATA/dorf/201_CRF_data.mat``.

DoRF, the Database of Response Functions (Grossberg & Nayar, "Modeling the Space of Camera Response Functions", PAMI
2004), comes from its owners, Columbia's CAVE (https://www.cs.columbia.edu/CAVE/software/softlib/dorf.php), as one text
file of 201 curves in six lines each: name, kind of the graph that it was read from, ``I =``, irradiances, ``B =``,
brightnesses. All values are linear, whatever the kind of graph ("graph-log-log-neg" describes the axes of the source).
"""

import argparse
from pathlib import Path

import numpy as np
import scipy.io

from crfnet_core.errors import CurveError
from crfnet_core.files import atomic_write
from crfnet_core.response.curve import UNIFORM
from crfnet_core.types import Float64Array

#: Number of curves in DoRF, and of lines of each.
CURVES, LINES = 201, 6


def parse_dorf(text: str) -> Float64Array:
    """Return the 201 responses at 1024 uniform irradiances, shape (201, 1024), in the text's order, or CurveError."""
    lines = [line for line in text.splitlines() if line.strip()]
    if len(lines) != CURVES * LINES:
        raise CurveError(f"{len(lines)} lines instead of {CURVES} curves of {LINES}; download dorfCurves.txt again")
    return np.stack([_curve(*lines[start : start + LINES]) for start in range(0, len(lines), LINES)])


def _curve(name: str, _graph: str, _i: str, irradiances: str, _b: str, brightnesses: str) -> Float64Array:
    """Return one curve at uniform irradiances, linear between its samples."""
    try:
        irradiance, brightness = samples = np.array([irradiances.split(), brightnesses.split()], float)
    except ValueError as problem:
        raise CurveError(f"{name}: two rows of as many numbers are needed ({problem})") from None
    is_rising = (np.diff(irradiance) > 0).all() and (np.diff(brightness) >= 0).all()
    if not (is_rising and np.allclose(samples[:, [0, -1]], [0, 1], rtol=0, atol=1e-6)):
        raise CurveError(f"{name}: is not a response from (0, 0) to (1, 1); download dorfCurves.txt again")
    return np.interp(UNIFORM, irradiance, brightness)


def main(arguments: list[str] | None = None) -> None:
    """Write the curves as a MAT-file with I and B, float32 (201, 1024)."""
    parser = argparse.ArgumentParser(description="Convert DoRF's own text.")
    parser.add_argument("source", type=Path, metavar="dorfCurves.txt")
    parser.add_argument("out", type=Path, metavar="201_CRF_data.mat")
    options = parser.parse_args(arguments)
    brightness = parse_dorf(options.source.read_text(encoding="latin-1"))
    irradiance = np.broadcast_to(UNIFORM, brightness.shape)
    with atomic_write(options.out) as temporary, temporary.open("wb") as file:
        scipy.io.savemat(file, {"I": irradiance.astype(np.float32), "B": brightness.astype(np.float32)})
    print(f"{options.out}: {len(brightness)} curves")


if __name__ == "__main__":
    main()
