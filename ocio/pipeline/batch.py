"""Many photographs, one task each: what they have in common, and which files belong to each."""

from __future__ import annotations

import hashlib
import itertools
import os
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.files import cut_to_bytes

from ..errors import PlateError
from ..options import EstimateOptions, PlateOptions
from ..output_files import LONGEST_STEM, check_targets, plain_stem
from ..plates.light import PlateLight
from ..report import result_line
from .estimates import response_lut
from .loading import load_camera_response
from .photographs import unreadable_reason, without_outputs
from .records import PhotographRecord, RecordFile

#: Bytes that a number behind a stem may need.
NUMBER_BYTES = 8


@dataclass(frozen=True, kw_only=True)
class Batch(ABC):
    """What many photographs have in common: the folder for everything, and how they are estimated and linearized."""

    out: Path
    options: EstimateOptions
    plates: PlateOptions

    @property
    @abstractmethod
    def records(self) -> RecordFile:
        """The file of records."""

    @abstractmethod
    def targets(self, folder: Path, stem: str) -> tuple[Path, ...]:
        """Return the files of one photograph alone."""

    @abstractmethod
    def done(self, task: Task) -> PhotographRecord:
        """Write the files of one photograph and return its record."""

    def shared_response(self) -> str | None:
        """Return which response all photographs have now: the stored camera's; None if each has its own."""
        stored = load_camera_response(self.options)
        return response_lut(stored).identity if stored else None

    @property
    def choices(self) -> dict[str, Any]:
        """The options that make two results differ."""
        chosen = {**asdict(self.options), **asdict(self.plates)}
        return {name: value for name, value in chosen.items() if name not in ("threads", "overwrite")}

    def digest(self) -> str:
        """Return a digest of the options and of the shared response."""
        text = repr(sorted((self.choices | {"response": self.shared_response()}).items()))
        return hashlib.sha256(text.encode(errors="backslashreplace")).hexdigest()[:16]


@dataclass(frozen=True)
class Task:
    """One photograph of a batch, and all that its worker gets.

    Its files lie in `folder`, relative to the batch's, and their names begin with `stem`, as those of no other
    photograph do. `options` is the batch's digest.
    """

    batch: Batch
    photo: Path
    folder: Path
    stem: str
    options: str

    @property
    def targets(self) -> tuple[Path, ...]:
        """The files of this photograph alone."""
        return self.batch.targets(self.folder, self.stem)

    def record(
        self,
        light: PlateLight,
        estimate: ResponseEstimate | None,
        *,
        lut: Path | None = None,
        linear: Sequence[Path] = (),
    ) -> PhotographRecord:
        """Return the record of this photograph, whose files are whole, and of its estimate if there is one."""
        record = PhotographRecord(
            photograph=str(self.photo),
            options=self.options,
            folder=self.folder.as_posix(),
            lut="".join(path.relative_to(self.batch.out).as_posix() for path in (lut,) if path),
            linear="".join(path.relative_to(self.batch.out).as_posix() for path in linear),
            exposure=light.stops,
            primaries=asdict(light.plate.primaries) if light.plate.primaries else None,
            primaries_source=light.plate.source,
            summary=f"{self.photo.name}: linear",
        )
        if estimate is None:
            return record
        kind = estimate.likely_kind
        return replace(
            record,
            weights=tuple(estimate.weights.tolist()),
            family=kind.words if kind else "",
            verdict=estimate.verdict,
            uncertainty=estimate.uncertainty,
            shape_uncertainty_stops=estimate.shape_uncertainty,
            warnings=tuple(map(str, estimate.warnings)),
            summary=result_line(estimate, name=self.photo.name),
        )

    def is_done(self, record: PhotographRecord | None) -> bool:
        """Return whether a record says that this photograph needs no work, and its files are still there."""
        if record is None or record.error or (record.folder, record.stem) != (self.folder.as_posix(), self.stem):
            return False
        return record.options == self.options and all(path.exists() for path in self.targets)


def plan_tasks(batch: Batch, photographs: Mapping[Path, Path], *, shared: Sequence[Path] = ()) -> tuple[Task, ...]:
    """Return what is to be done for each photograph, after checking that it can be; create nothing.

    Two photographs of one name in one folder get files of different names: a.jpg and a.png those of `a` and `a_2`.
    A photograph keeps the name that an earlier run has given it.

    Parameters
    ----------
    batch : Batch
        What they have in common.
    photographs : mapping of Path to Path
        As `find_photographs` returns them.
    shared : sequence of Path
        Files of several photographs, which must not replace a photograph.

    Raises
    ------
    CRFNetError
        If a photograph would be replaced, there are results of other options, or the folder cannot be used.
    """
    chosen, records = without_outputs(photographs, batch.out), batch.records.read()
    stems, digest = _distinct_stems(batch, chosen, records), batch.digest()
    tasks = tuple(Task(batch, photo, folder, stems[photo], digest) for photo, folder in chosen.items())
    for task in () if batch.plates.overwrite else tasks:
        record = records.get(str(task.photo))
        if record and not record.error and record.options != digest and any(map(os.path.lexists, task.targets)):
            raise PlateError("other_options", path=batch.records.path, photo=task.photo)
    targets = [path for task in tasks if not unreadable_reason(task.photo) for path in task.targets]
    check_targets(batch.out, targets, photos=list(chosen), shared=shared, overwrite=True)
    return tasks


def _distinct_stems(
    batch: Batch, photographs: Mapping[Path, Path], records: Mapping[str, PhotographRecord]
) -> dict[Path, str]:
    """Return a stem for each photograph whose files are nobody else's, on systems that take A for a, too."""
    owners: dict[str, str] = {}
    for record in records.values():
        owners |= dict.fromkeys(
            _keys(batch, Path(record.folder), record.stem) if record.stem else (), record.photograph
        )
    stems = {}
    for photo, folder in photographs.items():
        earlier = records.get(str(photo))
        stem = earlier.stem if earlier and earlier.folder == folder.as_posix() else ""
        for candidate in itertools.chain([stem] if stem else [], _stems(photo)):
            keys = _keys(batch, folder, candidate)
            if all(_same_file(owners.get(key, str(photo)), photo) for key in keys):
                owners |= dict.fromkeys(keys, str(photo))
                stems[photo] = candidate
                break
    return stems


def _keys(batch: Batch, folder: Path, stem: str) -> list[str]:
    """Return the names of a photograph's files, equal for those that some systems take for one."""
    return [str(path).casefold() for path in batch.targets(folder, stem)]


def _stems(photo: Path) -> Iterator[str]:
    """Yield names for the files of a photograph: its own, then with a number."""
    stem = plain_stem(photo)
    yield stem
    number = 2
    while True:
        yield f"{cut_to_bytes(stem, LONGEST_STEM - NUMBER_BYTES)}_{number}"
        number += 1


def _same_file(name: str, photo: Path) -> bool:
    """Return whether a name, perhaps by another way to its folder, is that of a photograph."""
    return os.path.normpath(Path(name).absolute()) == os.path.normpath(photo.absolute())
