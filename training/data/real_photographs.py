"""Real photographs of cameras whose responses were measured, and these responses by body.

No model is trained on the pixels. A prior may be made from the responses, out of fold wherever it is measured.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crfnet_core.photograph.image_io import read_metadata
from crfnet_core.photograph.metadata import FileMetadata, file_origin
from crfnet_core.photograph.metadata.jpeg import read_jpeg_header
from crfnet_core.response.curve import ResponseCurve
from training.data.scenes import table_rows

#: The two folders of real photographs, which are also their names in the report.
REAL, REAL_BODIES = "real", "real_bodies"

#: Grades of the measured responses of DATA/real that count; the others are shown apart.
TRUSTED_GRADES = ("A", "B")

#: What `use` says in DATA/real_bodies of a photograph that counts; the others are shown apart, with their reason.
USED, CAUTION = "yes", "caution: "

#: The kinds of the bodies of DATA/real, whose list has no such column.
KINDS = {row["camera"]: row["kind"] for row in table_rows(Path(__file__).with_name("real_kinds.csv"))}


@dataclass(frozen=True)
class RealPhotograph:
    """A photograph, its camera, and how well the camera's response was measured."""

    name: str
    body: str
    kind: str  # "phone", "compact", "camera" (with interchangeable lenses) or "unknown"
    grade: str  # how well the response was measured: A, B or C
    caution: str  # why the photograph does not count in the means; empty where it counts
    is_in_mean: bool  # whether its response is part of the mean of the other bodies
    fold: str  # bodies of one fold are left out of a mean together; its name is of one folder only
    photograph: Path  # its file
    measured: Path  # the file of its response
    metadata: FileMetadata | None = None  # of the original file, where `photograph` is not the original and has lost it

    @property
    def body_key(self) -> str:
        """The name of the body in lower case, since two folders may write it differently."""
        return self.body.casefold()

    @property
    def is_developed(self) -> bool:
        """Whether the file names a program that developed it from a raw file: its response is the program's."""
        return file_origin(self.metadata or read_metadata(self.photograph)).is_developed

    def truth(self) -> ResponseCurve:
        """Return the measured response."""
        return read_measured(self.measured)


def real_photographs(data: Path) -> dict[str, list[RealPhotograph]]:
    """Return folder -> photographs in its list's order: DATA/real and, where it exists, DATA/real_bodies."""
    sets = {REAL: [_of_real(data / REAL, row) for row in table_rows(data / REAL / "cases.csv")]}
    if (data / REAL_BODIES).is_dir():
        folder = data / REAL_BODIES
        sets[REAL_BODIES] = [_of_bodies(folder, row) for row in table_rows(folder / "cases.csv")]
    return sets


@dataclass(frozen=True)
class Body:
    """A camera body, of a kind as in `RealPhotograph`, and a response of each exposure stack."""

    key: str
    kind: str
    responses: tuple[ResponseCurve, ...]


def measured_bodies(data: Path, *, without: str | None = None) -> list[Body]:
    """Return the bodies of DATA/real and DATA/real_bodies whose photographs are the cameras' own renderings.

    The fold `without` is left out, and every body of the models in this fold, in both folders.
    """
    photographs = [photograph for folder in real_photographs(data).values() for photograph in folder]
    left_out = {model_key(photograph) for photograph in photographs if photograph.fold == without}
    others = [photograph for photograph in photographs if model_key(photograph) not in left_out]
    kept = [photograph for photograph in others if not photograph.is_developed]
    return [_body(key, kept) for key in sorted({photograph.body_key for photograph in kept})]


def model_key(photograph: RealPhotograph) -> str:
    """Return the camera model without what DATA/real says in brackets: two bodies of one model share it."""
    return photograph.body_key.partition(" (")[0]


def read_measured(path: Path) -> ResponseCurve:
    """Return a measured response: a file of irradiance and response."""
    return ResponseCurve.from_samples(np.loadtxt(path, delimiter=",", skiprows=1)[:, 1])


def _of_real(folder: Path, row: dict[str, str]) -> RealPhotograph:
    """Return the photograph of a row of DATA/real/cases.csv."""
    return RealPhotograph(
        name=row["id"],
        body=row["camera"],
        kind=KINDS.get(row["camera"], "unknown"),
        grade=row["grade"],
        caution="" if row["grade"] in TRUSTED_GRADES else f"grade {row['grade']}",
        is_in_mean=True,
        fold=row["camera"],
        photograph=folder / row["input_file"],
        measured=folder / "gt" / f"{row['id']}.csv",
    )


def _of_bodies(folder: Path, row: dict[str, str]) -> RealPhotograph:
    """Return the photograph of a row of DATA/real_bodies/cases.csv; one exposure stack has one response."""
    metadata = None
    if row["file"].endswith(".webp"):  # the others are the original files, byte for byte
        metadata = metadata_of_case(row, (folder / row["crop"]).read_bytes() if row["crop"] else b"")
    return RealPhotograph(
        name=row["id"],
        body=row["body"],
        kind=row["kind"],
        grade=row["grade"],
        caution=caution(row),
        is_in_mean=row["use"] == USED,
        fold=f"fold {row['fold']}",
        photograph=folder / row["file"],
        measured=folder / row["gt"],
        metadata=metadata,
    )


def caution(row: Mapping[str, str]) -> str:
    """Return why the photograph of a row of DATA/real_bodies/cases.csv does not count; empty where it counts."""
    return "" if row["use"] == USED else row["use"].removeprefix(CAUTION)


def metadata_of_case(row: Mapping[str, str], crop: bytes = b"") -> FileMetadata:
    """Return the metadata of the original file that a row of DATA/real_bodies/cases.csv still knows.

    `crop`, a JPEG cut without recompression, has the original's quantization tables. The size in EXIF, the profile and
    the XMP history are lost.
    """
    jpeg = read_jpeg_header(crop)
    width, height = (int(side) for side in row["original_size"].split("x"))
    return FileMetadata(
        width=width,
        height=height,
        make=row["exif_make"].strip(),
        model=row["exif_model"].strip(),
        software=row["exif_software"].strip(),
        iso=round(float(row["iso"])) if row["iso"] else None,
        luma_table=jpeg.luma_table,
        chroma_table=jpeg.chroma_table,
        file_format="JPEG",
    )


def _body(key: str, photographs: Sequence[RealPhotograph]) -> Body:
    """Return the body of this key."""
    of_body = [photograph for photograph in photographs if photograph.body_key == key]
    measured = {photograph.measured: photograph for photograph in of_body}
    return Body(key, of_body[0].kind, tuple(photograph.truth() for photograph in measured.values()))
