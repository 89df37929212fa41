"""Make the plates of the cases, and let the `crfnet` command estimate them.

``python -m tests.blender_window.make_files FOLDER`` runs in the project's own environment, beforehand, because a
Blender's Python need not have it.
"""

from __future__ import annotations

import contextlib
import io
import shutil
import sys
from pathlib import Path

import numpy as np

from crfnet.cli.main import main as crfnet
from tests.helpers.images import make_photograph, read_image, write_image

#: The bundled photograph.
PLATE = Path(__file__).resolve().parent.parent / "data" / "plate.jpg"

#: Size of the large plate, 12 megapixels.
LARGE = (4000, 3000)


def make_plates(folder: Path) -> None:
    """Write the plates into a folder.

    ``plate.jpg`` and ``a/IMG_0001.jpg`` are the bundled photograph, ``b/IMG_0001.jpg`` has another response.
    ``limited.png`` is the photograph in the codes 16 to 235 of video, and ``large.jpg`` has 12 megapixels.
    """
    for name in ("a", "b"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    shutil.copyfile(PLATE, folder / "plate.jpg")
    shutil.copyfile(PLATE, folder / "a" / "IMG_0001.jpg")
    codes = np.rint(read_image(PLATE) * 255)[..., :3].astype(np.uint8)
    bent = np.rint(255 * (codes / 255) ** 1.5).astype(np.uint8)
    write_image(folder / "b" / "IMG_0001.jpg", bent, Compression="jpeg:95")
    write_image(folder / "limited.png", np.rint(16 + 219 / 255 * codes).astype(np.uint8))
    make_photograph(folder / "large.jpg", *LARGE)


def main(folder: Path) -> int:
    """Write the plates, and what the command makes of the first, into a folder; return the exit code of the command."""
    make_plates(folder / "plates")
    out = folder / "expected" / "plate"
    arguments = ["estimate", str(folder / "plates" / "plate.jpg"), "--out", str(out), "--depth", "float", "--no-sheet"]
    with contextlib.redirect_stdout(io.StringIO()):
        return crfnet([*arguments, "--overwrite"])


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
