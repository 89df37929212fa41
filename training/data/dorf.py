"""Convert DoRF's own text: ``python -m training.data.dorf dorfCurves.txt --out DATA/dorf/201_CRF_data.mat``.

DoRF, the Database of Response Functions (Grossberg & Nayar, "Modeling the Space of Camera Response Functions", PAMI
2004), comes from its owners, Columbia's CAVE (https://www.cs.columbia.edu/CAVE/software/softlib/dorf.php), as one text
file. We know its format from other programs that read it. The following is relied on, and checked for every curve as
far as that is possible:

- a curve is six lines: its name, the kind of graph that it was taken from, ``I =``, irradiances, ``B =``, brightnesses
  (blank lines, and values that run over several lines, are read as well);
- irradiances increase from 0 to 1, brightnesses do not decrease and run from 0 to 1;
- both are linear, whatever the kind of graph says ("graph-log-log-neg" and the like describe the axes of the source);
- there are 201 curves.
"""

from __future__ import annotations

import argparse
import io
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.io
from numpy.typing import NDArray

from crfnet_core.errors import CRFNetError, CurveError
from crfnet_core.files import atomic_write, check_target
from training.data.curves import IRRADIANCE

#: Number of curves in DoRF.
CURVES = 201

#: Irradiances this close to uniform ones need no interpolation: the text has seven digits.
ROUNDING = 1e-6

#: The 116 bytes of text in front of a MAT-file; scipy would write the time of day there.
MAT_TEXT = b"MATLAB 5.0 MAT-file, DoRF (Grossberg & Nayar, Columbia CAVE) from dorfCurves.txt"


@dataclass(frozen=True, eq=False)
class DorfCurve:
    """A response of DoRF.

    name: name of the film, sensor or camera
    graph: the kind of graph that it was read from
    irradiance, brightness, (N,): samples from (0, 0) to (1, 1)
    """

    name: str
    graph: str
    irradiance: NDArray[np.float64]
    brightness: NDArray[np.float64]

    def resampled(self) -> NDArray[np.float64]:
        """Return the brightness at 1024 uniform irradiances from 0 to 1, linear between the samples."""
        if self.irradiance.shape == IRRADIANCE.shape and np.allclose(self.irradiance, IRRADIANCE, 0, ROUNDING):
            return self.brightness
        return np.interp(IRRADIANCE, self.irradiance, self.brightness)


def parse_dorf(text: str) -> list[DorfCurve]:
    """Return the curves in the text of dorfCurves.txt, in its order.

    Raise CurveError if there are none, or one is cut short, holds something else than numbers, or is not a response
    from 0 to 1.
    """
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    starts = [index for index, line in enumerate(lines) if line.replace(" ", "") == "I="]
    if not starts or starts[0] < 2:
        raise CurveError("holds no curve: a name, the kind of graph and a line 'I =' are needed")
    ends = [*(start - 2 for start in starts[1:]), len(lines)]
    return [_curve(lines[start - 2 : end]) for start, end in zip(starts, ends, strict=True)]


def convert(source: Path, out: Path, *, overwrite: bool = False) -> int:
    """Write the curves of dorfCurves.txt as a MAT-file with I and B, float32 (201, 1024), and return their number.

    Raise CRFNetError if the text cannot be read or does not hold all 201 curves, or the output cannot be written.
    """
    check_target(out, overwrite=overwrite)
    try:
        curves = parse_dorf(source.read_text(encoding="latin-1"))
    except OSError as problem:
        raise CurveError(f"{source}: cannot be read ({problem.strerror}); check the name") from problem
    except CurveError as problem:
        raise CurveError(f"{source}: {problem}") from problem
    if len(curves) != CURVES:
        raise CurveError(f"{source}: holds {len(curves)} curves, DoRF has {CURVES}; download dorfCurves.txt again")
    brightness = np.stack([curve.resampled() for curve in curves])
    with atomic_write(out, overwrite=overwrite) as temporary:
        temporary.write_bytes(mat_bytes(brightness))
    return len(curves)


def mat_bytes(brightness: NDArray[np.float64]) -> bytes:
    """Return a MAT-file of I and B, float32 (N, 1024), for brightness B of that shape; same curves, same bytes."""
    file = io.BytesIO()
    irradiance = np.broadcast_to(IRRADIANCE, brightness.shape)
    scipy.io.savemat(file, {"I": irradiance.astype(np.float32), "B": brightness.astype(np.float32)})
    return MAT_TEXT.ljust(116) + file.getvalue()[116:]


def _curve(lines: Sequence[str]) -> DorfCurve:
    """Return the curve in its lines; the first line is its name."""
    name, graph, _, *rest = lines
    middle = next((index for index, line in enumerate(rest) if line.replace(" ", "") == "B="), None)
    if middle is None:
        raise CurveError(f"the curve {name!r} has no line 'B ='; download the file again")
    try:
        irradiance, brightness = (
            np.array(" ".join(part).split(), float) for part in (rest[:middle], rest[middle + 1 :])
        )
    except ValueError as problem:
        raise CurveError(f"the curve {name!r} holds something else than numbers ({problem})") from problem
    for fault in _faults(irradiance, brightness):
        raise CurveError(f"the curve {name!r} {fault}; download the file again")
    return DorfCurve(name, graph, irradiance, brightness)


def _faults(irradiance: NDArray[np.float64], brightness: NDArray[np.float64]) -> Iterator[str]:
    """Yield every reason why samples are no response."""
    if len(irradiance) != len(brightness) or len(irradiance) < 2:
        yield f"has {len(irradiance)} irradiances and {len(brightness)} brightnesses"
    if not (np.isfinite(irradiance).all() and np.isfinite(brightness).all()):
        yield "has values that are not finite"
    if not ((np.diff(irradiance) > 0).all() and (np.diff(brightness) >= 0).all()):
        yield "is not increasing"
    for values in (irradiance, brightness):
        if not np.allclose(values[[0, -1]], [0, 1], 0, ROUNDING):
            yield f"runs from {values[0]:g} to {values[-1]:g} instead of 0 to 1"


def main(arguments: Sequence[str] | None = None) -> int:
    """Convert the file and return 0; if it cannot be converted, say why on stderr and return 2."""
    parser = argparse.ArgumentParser(prog="python -m training.data.dorf", description="Convert DoRF's own text.")
    parser.add_argument("source", type=Path, metavar="dorfCurves.txt", help="as downloaded from Columbia CAVE")
    parser.add_argument("--out", type=Path, required=True, help="DATA/dorf/201_CRF_data.mat")
    parser.add_argument("--overwrite", action="store_true", help="replace the output")
    options = parser.parse_args(arguments)
    try:
        count = convert(options.source, options.out, overwrite=options.overwrite)
    except CRFNetError as problem:
        print(f"dorf: error: {problem}", file=sys.stderr)
        return 2
    print(f"{options.out}: {count} curves")
    return 0


if __name__ == "__main__":
    sys.exit(main())
