"""Compare the estimate of the bundled photograph with its true response: the second half of `make demo`."""

import json
import sys
from pathlib import Path

import numpy as np

from crfnet_core.photograph.image_io import read_photo
from crfnet_core.response.curve import ResponseCurve
from crfnet_core.response.metrics import estimation_error, linearization_error, shape_error

ASSETS = Path(__file__).parent / "data"

INTRODUCTION = """
The true response of this photograph is known, because the photograph is simulated: a crop of one of Blender's studio
lights (Ninomaru Teien, CC0) was put through the formula of a camera-like response, noise and JPEG compression. See
tests/data/README.md. So the errors of the estimate can be measured:
"""

EXPLANATION = """
Response: distance of the curves (E_est); 1 is 3.1 % of the brightness range. Plate: RMS error of the linear plate, in
percent of its brightest light. Shape: error of the linear light once the exposure is matched. See docs/ACCURACY.md.
"""


def main(folder: Path) -> None:
    """Print the errors of the estimate in `folder` beside gamma 2.2, and the files that were written."""
    report = json.loads((folder / "plate.json").read_text(encoding="utf-8"))
    estimated = ResponseCurve.from_samples(report["response"]["brightness"])
    true = ResponseCurve.from_samples(np.loadtxt(ASSETS / "plate_response.csv", delimiter=",", skiprows=1)[:, 1])
    pixels = read_photo(ASSETS / "plate.jpg").pixels
    print(INTRODUCTION)
    print(f"  {'':<22}{'response (E_est)':>18}{'plate (E_lin x 100)':>22}{'shape (stops)':>16}")
    for name, curve in (("this estimate", estimated), ("gamma 2.2", ResponseCurve.gamma())):
        plate = 100 * linearization_error(pixels, true, curve)
        print(f"  {name:<22}{estimation_error(true, curve):>18.2f}{plate:>22.2f}{shape_error(true, curve):>16.2f}")
    curve, shape = report["uncertainty"], report["shape_uncertainty_stops"]
    print(f"  {'expected beforehand':<22}{curve:>18.2f}{'':>22}{shape:>16.2f}")
    print(EXPLANATION)
    for path in sorted(folder.iterdir()):
        print(f"  {path.stat().st_size / 1024:>8.0f} KB  {path}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
