"""Many photographs: what they have in common, and which files belong to each."""

from __future__ import annotations

import hashlib
import itertools
import os
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import ClassVar

from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.files import cut_to_bytes, escaped_name
from crfnet_core.posterior import Prior
from crfnet_core.types import CheckedFields

from ..defaults import CONFIG_NAME
from ..errors import PlateError, error_of_file
from ..luts.rgb_lut import AnyLut, lut_identity
from ..options import EstimateOptions, PlateOptions
from ..output_files import LONGEST_STEM, check_targets, folded, plain_stem
from ..plates.light import PlateLight, is_finished
from ..report.words import result_line
from .estimates import load_camera_response, load_network, response_lut
from .photographs import content_digest, file_state, real_place, unreadable_reason
from .records import PhotographRecord, RecordFile


@dataclass(frozen=True, kw_only=True)
class Batch(CheckedFields, ABC):
    """Many photographs: the folder for everything, and how they are estimated and linearized."""

    out: Path
    options: EstimateOptions
    plates: PlateOptions

    #: The name of the file of records in `out`; whether all photographs are estimated, and each folder gets a config.
    records_name: ClassVar[str]
    has_estimates: ClassVar[bool] = False

    @property
    def records(self) -> RecordFile:
        """The file of records."""
        return RecordFile(self.out / self.records_name)

    @abstractmethod
    def targets(self, folder: Path, stem: str) -> tuple[Path, ...]:
        """Return the files of one photograph alone; `folder` is relative to `out`."""

    @abstractmethod
    def done(self, task: Task) -> PhotographRecord:
        """Write the files of one photograph and return its record."""

    def finished(self, records: list[PhotographRecord]) -> list[PhotographRecord]:
        """Write what all photographs have in common, and return their records."""
        return records

    def response(self) -> tuple[AnyLut, ResponseEstimate | None] | None:
        """Return the response that all photographs have, with its estimate; None if each has its own.

        It is read anew each time, in 15 ms: the workers of a cluster outlive a run, and files change between runs.
        """
        stored = load_camera_response(self.options)
        return (response_lut(stored), stored) if stored else None

    def check(self) -> None:
        """Raise a CRFNetError if the response, the prior or the network cannot be read."""
        if not self.response() or self.has_estimates:
            Prior.load(self.options.prior)
            load_network(self.options.model, self.options.threads)

    def digest(self) -> str:
        """Return a digest of the common response and of the options that make two results differ."""
        choices, response = asdict(self), self.response()
        del choices["out"], choices["options"]["threads"], choices["plates"]["overwrite"]
        text = repr([choices, response and lut_identity(response[0])])
        return hashlib.sha256(text.encode(errors="backslashreplace")).hexdigest()[:16]


@dataclass(frozen=True)
class Task:
    """One photograph of a batch, and all that its worker gets.

    Its files lie in `folder`, relative to the batch's, and their names begin with `stem`, which no other photograph
    has there. `options` is the batch's digest.
    """

    batch: Batch
    photo: Path
    folder: Path
    stem: str
    options: str

    @property
    def name(self) -> str:
        """The path of the photograph as its record names it."""
        return escaped_name(self.photo)

    @property
    def place(self) -> str:
        """The path of the photograph by which its record is found."""
        return place_of(self.photo, self.batch.out)

    @property
    def targets(self) -> tuple[Path, ...]:
        """The files of this photograph alone."""
        return self.batch.targets(self.folder, self.stem)

    @property
    def existing(self) -> list[Path]:
        """The ones that are there."""
        return [path for path in self.targets if os.path.lexists(path)]

    def record(
        self, light: PlateLight, estimate: ResponseEstimate | None, *, lut: Path | None = None, linear: Sequence[Path]
    ) -> PhotographRecord:
        """Return the record of this photograph, whose files are whole, and of its estimate if there is one."""
        record = PhotographRecord(
            photograph=self.name,
            place=self.place,
            options=self.options,
            folder=self.folder.as_posix(),
            lut=lut.relative_to(self.batch.out).as_posix() if lut else "",
            linear=linear[0].relative_to(self.batch.out).as_posix() if linear else "",
            exposure=light.stops,
            primaries=asdict(light.plate.primaries) if light.plate.primaries else None,
            primaries_source=light.plate.source,
            summary=f"{self.photo.name}: linear EXR" + (f", though tagged as {light.tagged}" if light.tagged else ""),
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

    def failure(self, problem: BaseException) -> PhotographRecord:
        """Return the record of a problem; an interruption goes on."""
        error = str(error_of_file(problem, self.photo))
        return PhotographRecord(photograph=self.name, place=self.place, options=self.options, error=error)

    def is_done(self, record: PhotographRecord | None) -> bool:
        """Return whether a record says that this photograph needs no work, and its files are there, frames whole."""
        if record is None or record.error or (record.folder, record.stem) != (self.folder.as_posix(), self.stem):
            return False
        if record.options != self.options or not all(path.exists() for path in self.targets):
            return False
        is_whole = all(is_finished(path) for path in self.targets if path.suffix == ".exr")
        is_same = record.state == file_state(self.photo) or record.sha256 == content_digest(self.photo)
        return is_whole and is_same

    def is_outdated(self, record: PhotographRecord) -> bool:
        """Return whether files are there that were made, by the record, of other content of the photograph."""
        return bool(record.sha256 and self.existing) and content_digest(self.photo) not in ("", record.sha256)


def plan_tasks(batch: Batch, photographs: Mapping[Path, Path], records: Mapping[str, PhotographRecord]) -> list[Task]:
    """Return a task for each photograph of `find_photographs`, after checking that it can be done; create nothing.

    A photograph keeps its name of an earlier run. Raise PlateError if a photograph or a config of another program would
    be replaced, there are results of other options, or the folder cannot be used.
    """
    digest = batch.digest()
    folders = dict.fromkeys(photographs.values()) if batch.has_estimates else {}
    configs = [batch.out / folder / CONFIG_NAME for folder in folders]
    stems = _distinct_stems(batch, photographs, records)
    tasks = [Task(batch, photo, folder, stems[photo], digest) for photo, folder in photographs.items()]
    if not batch.plates.overwrite:
        _check_earlier(batch, tasks, records, configs)
    targets = [path for task in tasks if not unreadable_reason(task.photo) for path in task.targets]
    check_targets(batch.out, targets, photos=photographs, configs=configs, overwrite=True)
    careful = replace(batch, plates=replace(batch.plates, overwrite=False))  # another run may write the same meanwhile
    return [task if task.existing else replace(task, batch=careful) for task in tasks]


def _check_earlier(
    batch: Batch, tasks: Iterable[Task], records: Mapping[str, PhotographRecord], configs: Iterable[Path]
) -> None:
    """Refuse results of other options, and configs without any record, which are not ours."""
    for task in tasks:
        record = records.get(task.place)
        if record and not record.error and record.options != task.options and task.existing:
            raise PlateError("other_options", path=batch.records.path, photo=task.photo)
    for config in configs:
        if config.exists() and not batch.records.path.exists():
            raise PlateError("file_exists", path=config)


def _distinct_stems(
    batch: Batch, photographs: Mapping[Path, Path], records: Mapping[str, PhotographRecord]
) -> dict[Path, str]:
    """Return a stem for each photograph whose files belong to no other one, even on systems that take A for a."""

    def keys(folder: Path, stem: str) -> list[str]:
        return [folded(str(path)) for path in batch.targets(folder, stem)]

    owners: dict[str, str] = {}
    for record in records.values():
        if record.stem:
            owners |= dict.fromkeys(keys(Path(record.folder), record.stem), record.place)
    stems = {}
    for photo, folder in photographs.items():
        owner = place_of(photo, batch.out)
        earlier = records.get(owner)
        first = [earlier.stem] if earlier and earlier.stem and earlier.folder == folder.as_posix() else []
        for stem in itertools.chain(first, _stems(photo)):
            if all(owners.get(key, owner) == owner for key in keys(folder, stem)):
                break
        owners |= dict.fromkeys(keys(folder, stem), owner)
        stems[photo] = stem
    return stems


def _stems(photo: Path) -> Iterator[str]:
    """Yield names for the files of a photograph: its own, then with numbers from 2."""
    stem = plain_stem(photo)
    yield stem
    for number in itertools.count(2):
        yield f"{cut_to_bytes(stem, LONGEST_STEM - 8)}_{number}"  # the bytes of a number and its line


def place_of(photo: Path, out: Path) -> str:
    """Return the path from the output folder to a photograph, wherever a command runs and both are moved together."""
    with suppress(ValueError):  # of two drives
        return escaped_name(Path(os.path.relpath(real_place(photo), os.path.realpath(out))).as_posix())
    return escaped_name(real_place(photo).as_posix())
