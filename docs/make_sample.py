"""Write docs/sample/ anew: ``python docs/make_sample.py`` (needs the extra `plot`).

It holds the files that ``crfnet estimate tests/data/plate.jpg`` writes, except the linear plate; the sheet has half its
size.
"""

import contextlib
import io
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import image
from numpy.typing import NDArray

from crfnet.cli.main import main
from crfnet.luts.files import WRITERS

ROOT = Path(__file__).resolve().parents[1]
PHOTO = ROOT / "tests" / "data" / "plate.jpg"
SAMPLE = ROOT / "docs" / "sample"

#: Files that are copied.
COPIED = ("config.ocio", *(f"plate{suffix}" for suffix in WRITERS), "plate.json")

SHEET = "plate_sheet.png"

#: None leaves the version of matplotlib out, so that the same sheet gives the same bytes.
NO_METADATA: dict[str, Any] = {"Software": None}


def make_sample(folder: Path) -> None:
    """Write the sample files into `folder`, replacing earlier ones."""
    with tempfile.TemporaryDirectory() as name:
        written = Path(name)
        with contextlib.redirect_stdout(io.StringIO()):
            code = main(["estimate", str(PHOTO), "--out", name])
        if code != 0:
            sys.exit(code)
        for file in COPIED:
            shutil.copyfile(written / file, folder / file)
        image.imsave(folder / SHEET, halved(image.imread(written / SHEET)), metadata=NO_METADATA)


def halved(picture: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return a picture (H, W, C) at half its size, each pixel the mean of four, H and W being even."""
    height, width, channels = picture.shape
    means: NDArray[np.float32] = picture.reshape(height // 2, 2, width // 2, 2, channels).mean(axis=(1, 3))
    return means


if __name__ == "__main__":
    make_sample(Path(sys.argv[1]) if len(sys.argv) > 1 else SAMPLE)
