"""Import scene-linear photographs of your own: ``python -m training.data.import_scenes FILE... --out DATA/linear``.

LibRaw develops camera raw without tone curve, sharpening or automatic brightness; the sensor's white becomes 1. OpenEXR
and Radiance HDR files are read as they are. Each file becomes a half-float OpenEXR file and a row of manifest.csv.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from crfnet_core.errors import CRFNetError, PhotoError
from crfnet_core.files import atomic_write, atomic_write_text
from crfnet_core.photograph.image_io import first_line
from training.data.linear_files import linear_scene
from training.data.scenes import table_rows, table_text

#: Kind -> its name in the manifest.
KINDS = {"photograph": "photograph", "panorama": "panorama band"}

#: The columns of the manifest.csv of a folder of scenes.
COLUMNS = ("file", "kind", "width", "height", "source", "licence", "notes")


def import_scene(path: Path, folder: Path, *, kind: str = "photograph", licence: str = "not stated") -> dict[str, str]:
    """Write the scene in `path` to `folder` as OpenEXR, add it to the folder's manifest.csv and return its row.

    The folder is made if absent. Raise CRFNetError or OSError, and write nothing, if the name is taken, or if the file
    is absent, damaged, not scene-linear, too small or black: see `linear_scene`.
    """
    target, rows = folder / f"{path.stem}.exr", read_manifest(folder)
    if target.exists() or any(row["file"] == target.name for row in rows):
        raise PhotoError(f"{path}: {target} is there already; rename the file, or take out the other and its row")
    pixels, notes = linear_scene(path, is_panorama=kind == "panorama")
    height, width, _ = pixels.shape
    values = (target.name, KINDS[kind], str(width), str(height), f"imported: {path.name}", licence, "; ".join(notes))
    row = dict(zip(COLUMNS, values, strict=True))
    folder.mkdir(parents=True, exist_ok=True)
    write_scene(target, pixels)
    text = table_text(COLUMNS, [*rows, row])
    atomic_write_text(folder / "manifest.csv", text, overwrite=True, error=PhotoError)
    return row


def write_scene(path: Path, pixels: NDArray[np.float16]) -> None:
    """Write a scene, float16 (H, W, 3), as OpenEXR, whole or not at all; PhotoError if it cannot be written."""
    height, width, channels = pixels.shape
    header = oiio.ImageSpec(width, height, channels, oiio.HALF)
    header.attribute("DateTime", "")  # else OpenImageIO writes the time of day
    header.attribute("compression", "zip")
    with atomic_write(path, error=PhotoError) as temporary:
        image = oiio.ImageBuf(header)
        image.set_pixels(image.roi, np.ascontiguousarray(pixels))
        if image.has_error or not image.write(str(temporary)):
            raise PhotoError(f"{path}: cannot be written ({first_line(image.geterror())}); check the disk")


def read_manifest(folder: Path) -> list[dict[str, str]]:
    """Return the rows of a folder's manifest.csv, [] if there is none; PhotoError if it has other columns."""
    path = folder / "manifest.csv"
    rows = table_rows(path) if path.exists() else []
    for row in rows:
        if tuple(row) != COLUMNS:
            found = ", ".join(map(str, row))
            raise PhotoError(f"{path}: needs the columns {', '.join(COLUMNS)}, and no more; found {found}")
    return rows


def main(arguments: Sequence[str] | None = None) -> int:
    """Import every file that is usable and return 0; if some are not, say why on stderr and return 2."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="camera raw, OpenEXR or Radiance HDR")
    parser.add_argument("--out", type=Path, required=True, help="folder of the scenes, such as DATA/linear")
    parser.add_argument("--kind", choices=KINDS, default="photograph", help="panoramas are equirectangular, 2:1")
    parser.add_argument("--licence", default="not stated", help="licence for the manifest")
    options = parser.parse_args(arguments)
    failed = False
    for path in options.files:
        try:
            row = import_scene(path, options.out, kind=options.kind, licence=options.licence)
            print(f"{options.out / row['file']}: {row['kind']}, {row['width']} x {row['height']}, {row['notes']}")
        except (CRFNetError, OSError) as problem:
            failed = True
            print(f"import_scenes: error: {problem}", file=sys.stderr)
    return 2 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
