"""The two kinds of batches: photographs with the files of their estimates, and photographs as linear EXR."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from crfnet_core.estimate.result import ResponseEstimate

from ..configs.files import write_config
from ..configs.plate_color_space import PlateColorSpace
from ..configs.portable import portable_config
from ..defaults import ESTIMATES, PLATES
from ..errors import LutError, PlateError
from ..luts.files import read_lut
from ..luts.response import read_response
from ..luts.rgb_lut import AnyLut
from ..movies.library import is_movie
from ..movies.source import file_source
from ..options import OutputOptions
from ..output_files import OutputFiles, output_folder
from ..plates.frames import FrameSequence
from ..plates.linear import linearize_plates
from ..plates.primaries import linear_space
from .batch import Batch, Task
from .delivery import OutputPlan, deliver_estimate, estimated_light, with_light
from .estimates import estimate_files, response_lut
from .records import PhotographRecord

#: Most photographs of a folder that still gets a config: nobody chooses from a longer menu, and OpenColorIO's time to
#: build it grows with the square.
MAX_COLOR_SPACES = 1000


@dataclass(frozen=True, kw_only=True)
class EstimateBatch(Batch):
    """Photographs with the files of their estimates, which `outputs` chooses, and a config in each folder."""

    outputs: OutputOptions
    records_name = ESTIMATES
    has_estimates = True

    def files(self, folder: Path, stem: str) -> OutputFiles:
        """Return the files of one photograph."""
        return OutputFiles.named(self.out / folder, [Path(f"{stem}.jpg")], self.outputs)

    def targets(self, folder: Path, stem: str) -> tuple[Path, ...]:
        """Return the files of one photograph, except the config."""
        return self.files(folder, stem).unshared

    def done(self, task: Task) -> PhotographRecord:
        """Estimate one photograph and write its files."""
        is_complete = all(path.exists() for path in task.targets)  # as a killed run leaves it before its record
        estimated = estimate_files([file_source(task.photo)], self.options)
        light = estimated_light(estimated, self.plates)
        files = self.files(task.folder, task.stem)
        plates = replace(self.plates, overwrite=self.plates.overwrite or is_complete)
        deliver_estimate(OutputPlan(files, plates), estimated, light)
        return task.record(light, estimated.estimate, lut=files.lut, linear=files.linear)

    def finished(self, records: list[PhotographRecord]) -> list[PhotographRecord]:
        """Write the config of each folder; the record of a photograph whose LUT is damaged becomes an error."""
        damaged: dict[str, PhotographRecord] = {}
        with self.records.locked():  # two runs at once: the last that ends knows the records of both
            for entries in self._folders([record.place for record in records]):
                damaged |= self._write_config(entries)
        for record in damaged.values():
            self.records.append(record)  # so that the next run estimates the photograph again
        return [damaged.get(record.place, record) for record in records]

    def _folders(self, order: Sequence[str]) -> list[list[PhotographRecord]]:
        """Return the photographs of each folder that gets a config: all whose LUT is there."""
        every = self.records.read()
        folders: dict[str, list[PhotographRecord]] = {}
        for place in dict.fromkeys([*order, *sorted(every)]):  # whichever ended first
            if not every[place].error and (self.out / every[place].lut).exists():
                folders.setdefault(every[place].folder, []).append(every[place])
        return [records for records in folders.values() if len(records) <= MAX_COLOR_SPACES]

    def _write_config(self, records: Sequence[PhotographRecord]) -> dict[str, PhotographRecord]:
        """Write the config of one folder; return the photographs whose LUT is damaged."""
        spaces, check, damaged = [], {}, {}
        for record in records:
            files = self.files(Path(record.folder), record.stem)
            space = PlateColorSpace.from_outputs(files, Path(record.photograph))
            linear = linear_space(record.plate, self.plates.output_space)
            try:
                check[space.name] = read_lut(self.out / record.lut).channels[0]
                spaces.append(with_light(space, record.exposure, record.plate, linear))
            except LutError:
                error = str(LutError("lut_damaged_since", path=self.out / record.lut))
                damaged[record.place] = replace(record, error=error)
        write_config(files.config, portable_config(spaces), check=check, overwrite=True)
        return damaged


@dataclass(frozen=True, kw_only=True)
class LinearBatch(Batch):
    """Photographs as linear EXR, through the LUT in a file, the stored camera's response, or each through its own."""

    lut: Path | None
    records_name = PLATES

    def targets(self, folder: Path, stem: str) -> tuple[Path, ...]:
        """Return the linear EXR of one photograph."""
        return (self.out / folder / f"{stem}.exr",)

    def response(self) -> tuple[AnyLut, ResponseEstimate | None] | None:
        """Return the response in the file if there is one, else as every batch."""
        return (read_response(self.lut).lut, None) if self.lut else super().response()

    def done(self, task: Task) -> PhotographRecord:
        """Write the linear EXR of one photograph; one of the same light that is there already is left alone."""
        if is_movie(task.photo):
            raise PlateError("movie_in_batch", path=task.photo)
        photograph, targets = FrameSequence((task.photo,)), task.targets
        lut, estimate = self.response() or self._estimated(photograph)
        with output_folder(targets[0].parent):
            written = linearize_plates(photograph, targets, lut, self.plates, workers=1)
        record = task.record(written.light, estimate, linear=targets)
        clipped = f", {100 * written.clipped:.2g} % of the values clipped" if written.clipped else ""
        return replace(record, left_alone=bool(written.skipped), summary=record.summary + clipped)

    def _estimated(self, photograph: FrameSequence) -> tuple[AnyLut, ResponseEstimate]:
        """Return the response estimated from a photograph."""
        estimate = estimate_files([photograph], self.options).estimate
        return response_lut(estimate), estimate
