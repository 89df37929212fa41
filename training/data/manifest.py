"""Where the data comes from: ``python -m training.data.manifest --data DATA`` writes training/data/manifest.csv.

A row for every file that models are trained on or figures rest on: what it is, where it comes from, its licence, its
SHA-256, and how it is used. The files themselves are no part of the repository. With ``--check`` the command compares a
data folder with the manifest instead: it lists the files that are absent, altered or unlisted, and returns 2 if any.
"""

import argparse
import hashlib
import sys
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path

from crfnet_core.errors import CRFNetError
from crfnet_core.files import atomic_write_text, file_sha256
from training.data.curves import BASE_CURVES_FILE, DORF_FILE, EMOR_FILE
from training.data.scenes import split_scenes, table_rows, table_text

#: The manifest of the data that the packaged models were trained and measured with. Beside it, manifest_crfnet2017.csv
#: lists 66 more scenes of crfnet2017-2.0 alone, which are in no data folder; their hashes are of the originals.
MANIFEST_FILE = Path(__file__).with_name("manifest.csv")

#: Comes with DoRF; nothing reads it.
UNUSED = "dorf/invemor.txt"

#: The tables that come with the data, and what each decides of the files that it names.
TABLES = {
    "linear/manifest.csv": "decides the split",
    "real/cases.csv": "decides the grade",
    "real_bodies/cases.csv": "decides grade, fold and use",
}

#: How real photographs are used, and the license of a file whose source states none.
MEASURED_ONLY, NO_LICENCE = "measured only", "no licence stated"

_CAVE = "Columbia CAVE, https://www.cs.columbia.edu/CAVE/software/softlib/dorf.php (Grossberg & Nayar, PAMI 2004)"
_DARKTABLE = "figures of the base-curve presets of darktable (src/iop/basecurve.c), https://github.com/darktable-org"


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


def manifest_rows(data: Path) -> list[ManifestRow]:
    """Return the rows of a data folder, sorted by file; CRFNetError if a file that its own tables name is absent."""
    unhashed = {*_curves(), *_tables(data), *_scenes(data), *_real(data)}
    return sorted(_hashed(data, row) for row in unhashed)


def training_digest(data: Path) -> str:
    """Return the SHA-256 over the manifest rows of the scenes and curves in the folder `data`."""
    chosen = [*(row for row in _curves() if row.file != EMOR_FILE), *_scenes(data)]
    return hashlib.sha256(manifest_text(sorted(_hashed(data, row) for row in chosen)).encode()).hexdigest()


def manifest_text(rows: Iterable[ManifestRow]) -> str:
    """Return the text of a manifest."""
    return table_text(COLUMNS, map(asdict, rows))


def read_manifest(path: Path = MANIFEST_FILE) -> list[ManifestRow]:
    """Return the rows of a manifest."""
    return [ManifestRow(**row) for row in table_rows(path)]


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


def _hashed(data: Path, row: ManifestRow) -> ManifestRow:
    """Return a row with its SHA-256."""
    path = data / row.file
    if not path.is_file():
        raise CRFNetError(f"{path}: is absent; restore it, or take its line out of the table beside it")
    return replace(row, sha256=file_sha256(path))


def _curves() -> list[ManifestRow]:
    """Return the rows, not hashed, of the files of responses."""
    measured, use = f"{_CAVE}: 201 measured responses", "by groups of curves: splits.json"
    return [
        ManifestRow(DORF_FILE, "responses", measured, NO_LICENCE, use),
        ManifestRow(EMOR_FILE, "responses", f"{_CAVE}: EMoR basis", NO_LICENCE, "compared only"),
        ManifestRow(BASE_CURVES_FILE, "responses", _DARKTABLE, "GPL-3.0-or-later (darktable)", "train"),
    ]


def _tables(data: Path) -> list[ManifestRow]:
    """Return the rows, not hashed, of the tables that the data folder holds."""
    source = "written for this data: it names the files, their sources and their licences"
    present = [(file, use) for file, use in TABLES.items() if (data / file).is_file()]
    return [ManifestRow(file, "table", source, "facts", use) for file, use in present]


def _scenes(data: Path) -> list[ManifestRow]:
    """Return the rows, not hashed, of the scenes in linear/manifest.csv."""
    splits = {name: split for split, scenes in split_scenes(data / "linear").items() for name, _ in scenes}
    return [
        ManifestRow(f"linear/{row['file']}", "scene", row["source"], row["licence"], splits[row["file"]])
        for row in _table(data / "linear" / "manifest.csv")
    ]


def _real(data: Path) -> list[ManifestRow]:
    """Return the rows, not hashed, of real photographs, their crops and their measured responses."""
    rows = []
    for case in _table(data / "real" / "cases.csv"):
        files = [f"real/{case['input_file']}"]
        rows += _case(case, files, f"real/gt/{case['id']}.csv", case["source_input"], MEASURED_ONLY)
    for case in _table(data / "real_bodies" / "cases.csv"):
        files = [f"real_bodies/{name}" for name in (case["file"], case["crop"]) if name]
        use = f"{MEASURED_ONLY}, fold {case['fold']}"
        rows += _case(case, files, f"real_bodies/{case['gt']}", case["source_dir"], use)
    return rows


def _case(case: dict[str, str], files: list[str], response: str, source: str, use: str) -> list[ManifestRow]:
    """Return the rows, not hashed, of the files of a real photograph and of its measured response."""
    repository, licence = case["source_repo"], NO_LICENCE if case["licence"].startswith("none") else case["licence"]
    measured = f"measured from an exposure stack of {repository}"
    return [
        *(ManifestRow(file, "real photograph", f"{repository}:{source}", licence, use) for file in files),
        ManifestRow(response, "measured response", measured, "measured figures", use),
    ]


def _table(path: Path) -> list[dict[str, str]]:
    """Return the rows of a table that comes with the data; none where it is absent."""
    return table_rows(path) if path.is_file() else []


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the manifest; with --check, list what differs from it and return 2 if anything does."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf, camera_curves, linear, real ...")
    parser.add_argument("--check", action="store_true", help="compare the folder with the manifest, write nothing")
    parser.add_argument("--manifest", type=Path, default=MANIFEST_FILE, help="training/data/manifest.csv")
    options = parser.parse_args(arguments)
    try:
        if options.check:
            found = differences(options.data, read_manifest(options.manifest))
            print("\n".join(found) or f"{options.data}: as {options.manifest.name} says")
            return 2 if found else 0
        rows = manifest_rows(options.data)
    except CRFNetError as problem:
        print(f"manifest: error: {problem}", file=sys.stderr)
        return 2
    atomic_write_text(options.manifest, manifest_text(rows), overwrite=True)
    print(f"wrote {options.manifest.name}: {len(rows)} files")
    return 0


if __name__ == "__main__":
    sys.exit(main())
