"""Write golden_statistics.npz: three windows of the bundled photograph, and their statistics.

    python -m tests.data.make_golden_statistics

Run it after a change of the statistics that is meant, and train the network anew: its predictions rest on them.
"""

from pathlib import Path

import numpy as np

from crfnet_core.photograph.image_io import read_photo
from crfnet_core.statistics import window_statistics
from crfnet_core.statistics.windows import cut_windows, select_windows

ASSETS = Path(__file__).parent

#: Windows taken of the photograph.
WINDOWS = 3


def main() -> None:
    """Write windows, uint8 code values (3, 227, 227, 3), and statistics, float32 (3, LENGTH)."""
    pixels = read_photo(ASSETS / "plate.jpg").pixels
    windows = cut_windows(pixels, select_windows(pixels, count=WINDOWS))
    np.savez_compressed(
        ASSETS / "golden_statistics.npz",
        windows=np.rint(windows * 255).astype(np.uint8),
        statistics=np.stack([window_statistics(window) for window in windows]),
    )


if __name__ == "__main__":
    main()
