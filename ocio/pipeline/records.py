"""The file of records: one JSON line for each photograph of a batch, appended when its files are whole.

Nothing is ever rewritten, so several runs may append to one file at once, and a killed run loses one line at most. Of
several records of one photograph, the last holds.
"""

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, BinaryIO, Self

from crfnet_core.colorimetry import Primaries
from crfnet_core.files import parse_json
from crfnet_core.locks import lock
from crfnet_core.types import LARGEST, typed_value

from ..errors import PlateError
from ..plates.primaries import PlatePrimaries

#: A number that may be negative.
Signed = Annotated[float, (-LARGEST, LARGEST)]

#: How every line begins, and what is left of one that a killed run has cut short.
_START = b'{"photograph": "'


@dataclass(frozen=True, kw_only=True)
class PhotographRecord:
    """The result of one photograph; docs/each.schema.json describes the entries."""

    photograph: str
    place: str
    sha256: str = ""
    state: str = ""
    options: str = ""
    folder: str = ""
    lut: str = ""
    linear: str = ""
    weights: tuple[Signed, ...] = ()
    family: str = ""
    verdict: str = ""
    uncertainty: float | None = None
    shape_uncertainty_stops: float | None = None
    warnings: tuple[str, ...] = ()
    exposure: Signed = 0.0
    primaries: Mapping[str, Any] | None = None
    primaries_source: str = ""
    summary: str = ""
    left_alone: bool = False
    error: str = ""

    @classmethod
    def from_entry(cls, entry: Mapping[str, Any]) -> Self:
        """Return the record of a line, without unknown entries; what is not a record raises errors of Python."""
        record: Self = typed_value(entry, cls)
        typed_value(record.plate.name, str)
        paths = map(PurePosixPath, (record.folder, record.lut, record.linear))
        if any(path.is_absolute() or ".." in path.parts for path in paths):
            raise ValueError("a path leads elsewhere")  # files there might be replaced
        return record

    @property
    def plate(self) -> PlatePrimaries:
        """The primaries of the photograph."""
        if self.primaries is None:
            return PlatePrimaries(None, self.primaries_source)
        return PlatePrimaries(Primaries.from_dict(self.primaries), self.primaries_source)

    @property
    def line(self) -> str:
        """The result in one line of words, or why there is none."""
        return self.error or self.summary + "; already there and left alone" * self.left_alone

    @property
    def stem(self) -> str:
        """The name of its files, without folder and suffix; empty if there are none."""
        return PurePosixPath(self.lut or self.linear).stem


@dataclass(frozen=True)
class RecordFile:
    """A file of records, which need not exist yet; its folder must before a record is appended."""

    path: Path

    def read(self) -> dict[str, PhotographRecord]:
        """Return each photograph's last record by its place, without a line cut short; PlateError for another file."""
        if not os.path.lexists(self.path):
            return {}
        is_file = self.path.is_file() and not self.path.is_symlink()
        *lines, cut = self.path.read_bytes().split(b"\n") if is_file else [b"a link"]
        if not _START.startswith(cut.rstrip(b"\0")[: len(_START)]):  # zeros, after a failure of power
            raise PlateError("not_records", path=self.path)
        try:
            records = [PhotographRecord.from_entry(parse_json(line)) for line in lines]
        except (ArithmeticError, AttributeError, KeyError, TypeError, ValueError) as problem:
            raise PlateError("not_records", path=self.path) from problem
        return {record.place: record for record in records}

    def append(self, record: PhotographRecord, *, files: Sequence[Path] = ()) -> None:
        """Append a record, and see that it is on the disk; not an error if another run has recorded its `files`."""
        text = json.dumps(asdict(record), ensure_ascii=False) + "\n"
        try:
            with self.locked() as file:
                earlier = self.read().get(record.place) if record.error and files else None
                if earlier and not earlier.error and (self.path.parent / (earlier.lut or earlier.linear)).is_file():
                    return
                self._drop_cut_line(file)
                file.write(text.encode(errors="backslashreplace"))  # as JSON escapes what is not text
                file.flush()
                os.fsync(file.fileno())
        except OSError as problem:  # to close the file raises again what failed in it
            raise PlateError("not_written", path=self.path, reason=problem.strerror) from problem

    def mend(self) -> None:
        """Remove what a killed run has written of its last line."""
        if self.path.exists():
            with self.locked() as file:
                self._drop_cut_line(file)

    @contextmanager
    def locked(self) -> Iterator[BinaryIO]:
        """Open the file for appending, with no other process in such a block meanwhile."""
        no_link = getattr(os, "O_NOFOLLOW", 0)  # which others may have put there
        with open(self.path, "a+b", opener=lambda path, flags: os.open(path, flags | no_link, 0o666)) as file:
            lock(file)
            yield file

    def _drop_cut_line(self, file: BinaryIO) -> None:
        """Remove what a killed run has written of its last line; a PlateError for another file."""
        file.seek(max(file.seek(0, os.SEEK_END) - 1, 0))
        if file.read() not in (b"", b"\n"):
            self.read()
            file.seek(0)
            file.truncate(file.read().rfind(b"\n") + 1)
