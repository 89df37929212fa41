"""Import scene-linear photographs of your own: ``python -m training.data.import_scenes FILE... --out DATA/linear``.

LibRaw develops camera raw without tone curve, sharpening or automatic brightness; the sensor's white becomes 1. OpenEXR
and Radiance HDR files are read as they are. Each file becomes a half-float OpenEXR file and a row of manifest.csv.
"""

from __future__ import annotations

import argparse
import csv
import io
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from crfnet_core.errors import CRFNetError, PhotoError
from crfnet_core.files import atomic_write, atomic_write_text, check_target
from crfnet_core.photograph.image_io import first_line
from training.data.linear_files import LEAST_SIDE, linear_scene
from training.data.scenes import IMPORTED

#: Kind -> its name in the manifest.
KINDS = {"photograph": "photograph", "panorama": "panorama band"}


@dataclass(frozen=True)
class ManifestRow:
    """A row of the folder's manifest.csv; the columns have this order."""

    file: str
    kind: str
    width: int
    height: int
    source: str
    licence: str
    notes: str


COLUMNS = tuple(field.name for field in fields(ManifestRow))


def import_scene(
    path: str | Path,
    folder: str | Path,
    *,
    kind: str = "photograph",
    scale: int | None = None,
    licence: str = "not stated",
    overwrite: bool = False,
) -> ManifestRow:
    """Write the scene in `path` to `folder` as OpenEXR, add it to the folder's manifest.csv and return its row.

    `linear_scene` explains the kinds of files, panoramas and `scale`. The folder and its manifest.csv are made if
    absent; `overwrite` replaces a scene of the same name. Raise CRFNetError, and write nothing, if the file is absent,
    damaged, not scene-linear, too small or black, or if its name is taken.
    """
    path, folder = Path(path), Path(folder)
    target = folder / f"{path.stem}.exr"
    rows = read_manifest(folder)
    if not overwrite and (target.exists() or any(row["file"] == target.name for row in rows)):
        raise PhotoError(f"{path}: {target} is there already; rename the file or ask to overwrite it")
    if target.exists() and path.exists() and target.samefile(path):
        raise PhotoError(f"{path}: is a file of the folder {folder} itself; give files from elsewhere")
    pixels, notes = linear_scene(path, is_panorama=kind == "panorama", scale=scale)
    height, width, _ = pixels.shape
    row = ManifestRow(target.name, KINDS[kind], width, height, f"{IMPORTED} {path.name}", licence, "; ".join(notes))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise PhotoError(f"{folder}: cannot be made ({problem.strerror}); choose another folder") from problem
    check_target(folder / "manifest.csv", overwrite=True, error=PhotoError)
    write_scene(target, pixels, overwrite=overwrite)
    others = [other for other in rows if other["file"] != target.name]
    write_manifest(folder, [*others, {name: str(value) for name, value in asdict(row).items()}])
    return row


def write_scene(path: Path, pixels: NDArray[np.float16], *, overwrite: bool = False) -> None:
    """Write a scene, float16 (H, W, 3), as OpenEXR, whole or not at all; PhotoError if it cannot be written."""
    height, width, channels = pixels.shape
    header = oiio.ImageSpec(width, height, channels, oiio.HALF)
    header.attribute("DateTime", "")  # else OpenImageIO writes the time of day
    header.attribute("compression", "zip")
    with atomic_write(path, overwrite=overwrite, error=PhotoError) as temporary:
        image = oiio.ImageBuf(header)
        image.set_pixels(image.roi, np.ascontiguousarray(pixels))
        if image.has_error or not image.write(str(temporary)):
            raise PhotoError(f"{path}: cannot be written ({first_line(image.geterror())}); check the disk")


def read_manifest(folder: Path) -> list[dict[str, str]]:
    """Return the rows of a folder's manifest.csv, [] if there is none; PhotoError if it has other columns."""
    path = folder / "manifest.csv"
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        rows = list(reader)
    columns = tuple(reader.fieldnames or ())
    if columns != COLUMNS or any(None in row for row in rows):
        raise PhotoError(f"{path}: needs the columns {', '.join(COLUMNS)}, and no more; found {', '.join(columns)}")
    return rows


def write_manifest(folder: Path, rows: Sequence[dict[str, str]]) -> None:
    """Write a folder's manifest.csv, whole or not at all, with the line ends of RFC 4180."""
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS)
    writer.writeheader()
    writer.writerows(rows)
    atomic_write_text(folder / "manifest.csv", text.getvalue(), overwrite=True, error=PhotoError)


def _parser() -> argparse.ArgumentParser:
    """Return the parser of the command."""
    parser = argparse.ArgumentParser(
        prog="python -m training.data.import_scenes", description=(__doc__ or "").split("\n", 1)[0]
    )
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="camera raw, OpenEXR or Radiance HDR")
    parser.add_argument("--out", type=Path, required=True, help="folder of the scenes, such as DATA/linear")
    parser.add_argument("--scale", type=int, help=f"whole factor (default: shorter side at least {LEAST_SIDE})")
    parser.add_argument("--kind", choices=KINDS, default="photograph", help="panoramas are equirectangular, 2:1")
    parser.add_argument("--licence", default="not stated", help="licence for the manifest")
    parser.add_argument("--overwrite", action="store_true", help="replace scenes of the same name")
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Import every file that is usable and return 0; if some are not, say why on stderr and return 2."""
    options = _parser().parse_args(arguments)
    settings = {"kind": options.kind, "scale": options.scale, "licence": options.licence}
    names = Counter(path.stem for path in options.files)
    failed = 0
    for path in options.files:
        try:
            if names[path.stem] > 1:
                raise PhotoError(f"{path}: {names[path.stem]} of these files would become {path.stem}.exr; rename them")
            row = import_scene(path, options.out, overwrite=options.overwrite, **settings)
            print(f"{options.out / row.file}: {row.kind}, {row.width} x {row.height}, {row.notes}")
        except CRFNetError as problem:
            failed += 1
            print(f"import_scenes: error: {problem}", file=sys.stderr)
    return 2 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
