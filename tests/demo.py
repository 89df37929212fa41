"""Say how good the estimate of the bundled photograph is: `make demo` runs this after `crfnet estimate`."""

import json
import sys
from pathlib import Path

import numpy as np

from crfnet_core.image_io import read_photo
from crfnet_core.metrics import estimation_error, linearization_error
from crfnet_core.response import ResponseCurve

ASSETS = Path(__file__).parent / "data"


def main(folder: Path) -> None:
    """Print the true error of the estimate in `folder`, how the photograph was made, and the files."""
    report = json.loads((folder / "plate.json").read_text(encoding="utf-8"))
    estimated = ResponseCurve.from_samples(report["response"]["brightness"])
    true = ResponseCurve.from_samples(np.loadtxt(ASSETS / "plate_response.csv", delimiter=",", skiprows=1)[:, 1])
    pixels = read_photo(ASSETS / "plate.jpg").pixels
    print("\nThe true response of this photograph is known: it is a crop of one of Blender's studio lights (Ninomaru")
    print("Teien, CC0), put through a formula like a camera's, noise and JPEG; tests/data/README.md says how.\n")
    print(f"  {'':<22}{'response (E_est)':>18}{'plate (E_lin x 100)':>22}")
    for name, curve in (("this estimate", estimated), ("gamma 2.2", ResponseCurve.gamma())):
        plate = 100 * linearization_error(pixels, true, curve)
        print(f"  {name:<22}{estimation_error(true, curve):>18.2f}{plate:>22.2f}")
    print(f"  {'expected beforehand':<22}{report['uncertainty']:>18.2f}\n")
    for path in sorted(folder.iterdir()):
        print(f"  {path.stat().st_size / 1024:>8.0f} KB  {path}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
