"""Where the data comes from: ``python -m training.data.manifest --data DATA`` compares a data folder with manifest.csv.

It has a row for every file that models are trained on or figures rest on: what it is, where it comes from, its licence,
its SHA-256, and how it is used. The files themselves are no part of the repository. The command lists the files that
are absent, altered or unlisted, and returns 2 if any. A new file is a new row, written by hand.
"""

import argparse
import hashlib
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path

from crfnet_core.files import file_sha256
from training.data.curves import BASE_CURVES_FILE, DORF_FILE
from training.data.scenes import table_rows, table_text
from training.data.splits import split_scenes

#: The manifest of the data that the packaged models were trained and measured with. Beside it, manifest_crfnet2017.csv
#: lists 66 more scenes of crfnet2017-2.0 alone, which are in no data folder; their hashes are of the originals.
MANIFEST_FILE = Path(__file__).with_name("manifest.csv")

#: Comes with DoRF; nothing reads it.
UNUSED = "dorf/invemor.txt"


@dataclass(frozen=True, order=True)
class ManifestRow:
    """One file: its path in the data folder, where it comes from, and the license as the source states it."""

    file: str
    kind: str  # "scene", "real photograph", "measured response" (of a real photograph), "responses" or "table"
    source: str
    licence: str
    split: str  # "train", "validation" or "test" of a scene; what a table decides; otherwise how the file is used
    sha256: str = ""


COLUMNS = tuple(field.name for field in fields(ManifestRow))


def read_manifest(path: Path = MANIFEST_FILE) -> list[ManifestRow]:
    """Return the rows of a manifest."""
    return [ManifestRow(**row) for row in table_rows(path)]


def training_digest(data: Path) -> str:
    """Return the SHA-256 over the manifest rows of the scenes and curves in the folder `data`, imported scenes too."""
    splits = {name: split for split, scenes in split_scenes(data / "linear").items() for name, _ in scenes}
    rows = [row for row in read_manifest() if row.file in (DORF_FILE, BASE_CURVES_FILE)]
    rows += [
        ManifestRow(f"linear/{row['file']}", "scene", row["source"], row["licence"], splits[row["file"]])
        for row in table_rows(data / "linear" / "manifest.csv")
    ]
    hashed = sorted(replace(row, sha256=file_sha256(data / row.file)) for row in rows)
    return hashlib.sha256(table_text(COLUMNS, map(asdict, hashed)).encode()).hexdigest()


def differences(data: Path, listed: Sequence[ManifestRow]) -> list[str]:
    """Return a line for every listed file that is absent or altered, and for every file beside them that is unlisted.

    Scenes of one's own, which `training.data.import_scenes` adds, are unlisted, and linear/manifest.csv is altered.
    """
    lines = []
    for row in listed:
        if not (data / row.file).is_file():
            lines.append(f"absent: {row.file}")
        elif file_sha256(data / row.file) != row.sha256:
            lines.append(f"altered: {row.file}")
    folders = {(data / row.file).parent for row in listed}
    known = {row.file for row in listed} | {UNUSED}
    present = (path for folder in folders if folder.is_dir() for path in folder.iterdir() if path.is_file())
    unlisted = {path.relative_to(data).as_posix() for path in present} - known
    return lines + [f"unlisted: {name}" for name in sorted(unlisted)]


def main(arguments: Sequence[str] | None = None) -> int:
    """List what differs from the manifest, and return 2 if anything does."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf, camera_curves, linear, real ...")
    data = parser.parse_args(arguments).data
    found = differences(data, read_manifest())
    print("\n".join(found) or f"{data}: as {MANIFEST_FILE.name} says")
    return 2 if found else 0


if __name__ == "__main__":
    sys.exit(main())
