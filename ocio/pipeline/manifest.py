"""The manifest of many photographs: JSON lines, first the settings, then what became of each photograph."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from crfnet_core.errors import PhotoError
from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.files import atomic_write_text, parse_json
from crfnet_core.photograph.metadata.color_tags import Primaries

from ..errors import PlateError
from ..plates.light import PlateLight
from ..plates.primaries import PlatePrimaries
from ..report import result_line

#: Settings that are called otherwise than in `crfnet.options` -> the options that people give.
OPTIONS = {"device": "--taken-with", "gray": "--exposure", "lut_length": "--length"}

#: The setting that says which response the LUT, or the stored camera, of a run holds; absent in earlier manifests.
RESPONSE = "response"

#: Settings that are on or off -> the option, and which of the two it stands for.
SWITCHES = {
    "use_metadata": ("--ignore-metadata", False),
    "is_encoded": ("--encoded", True),
    "has_sheet": ("--no-sheet", False),
    "has_linear": ("--no-linear", False),
    "has_forward": ("--forward", True),
}


@dataclass(frozen=True, kw_only=True)
class PhotographRecord:
    """What became of one photograph.

    Parameters
    ----------
    photograph : str
        The file, as it was given.
    folder : str
        The folder of its files, relative to the manifest.
    linear : str
        The linear EXR, relative to the manifest; empty in a manifest of estimates.
    weights : tuple of float
        Eleven EMoR weights of the response; empty if it was given as a LUT, and so is what follows up to the exposure.
    family : str
        What the picture most likely is, in words.
    verdict : str
        "good", "usable" or "do not trust".
    uncertainty, shape_uncertainty_stops : float
        The expected E_est, and the expected shape error in stops.
    warnings : tuple of str
        What makes a poor estimate likely; empty in manifests of earlier versions.
    exposure : float
        Stops added after the inverse response.
    primaries : mapping, optional
        The fields of the photograph's `Primaries`; None if they are unknown.
    primaries_source : str
        Who says so.
    summary : str
        The result in one line of words.
    error : str
        Why there is no estimate; empty if there is one.
    """

    photograph: str
    folder: str = ""
    linear: str = ""
    weights: tuple[float, ...] = ()
    family: str = ""
    verdict: str = ""
    uncertainty: float | None = None
    shape_uncertainty_stops: float | None = None
    warnings: tuple[str, ...] = ()
    exposure: float = 0.0
    primaries: Mapping[str, Any] | None = None
    primaries_source: str = ""
    summary: str = ""
    error: str = ""

    @classmethod
    def of(
        cls, photograph: Path, folder: Path, light: PlateLight, estimate: ResponseEstimate | None, *, linear: str = ""
    ) -> PhotographRecord:
        """Return the record of a photograph, and of its estimate if there is one."""
        record = cls(
            photograph=str(photograph),
            folder=folder.as_posix(),
            linear=linear,
            exposure=light.stops,
            primaries=asdict(light.plate.primaries) if light.plate.primaries else None,
            primaries_source=light.plate.source,
            summary=f"{photograph.name}: linear",
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
            summary=result_line(estimate, name=photograph.name),
        )

    @property
    def plate(self) -> PlatePrimaries:
        """The primaries of the photograph."""
        if self.primaries is None:
            return PlatePrimaries(None, self.primaries_source)
        fields: dict[str, Any] = {
            name: tuple(map(float, value)) if isinstance(value, list) else value
            for name, value in self.primaries.items()
        }
        return PlatePrimaries(Primaries(**fields), self.primaries_source)


class Manifest:
    """A manifest file, to which each record is added as soon as it is known; a killed run loses the last one at most.

    Parameters
    ----------
    path : Path
        The file; its folder must exist.
    settings : mapping
        What all estimates have in common, ready for JSON.
    overwrite : bool
        Whether to begin anew.

    Raises
    ------
    PlateError
        If the file is of a run with other settings, or is no manifest.
    """

    def __init__(self, path: Path, settings: Mapping[str, Any], *, overwrite: bool = False) -> None:
        self.path, self.settings = path, dict(settings)
        self.records: dict[str, PhotographRecord] = {}
        if path.exists() and not overwrite:
            self._read()
        self.rewrite(self.records)

    def add(self, record: PhotographRecord) -> None:
        """Add a record, and write it at once."""
        self.records[record.photograph] = record
        with self.path.open("a", encoding="utf-8", newline="\n") as file:
            file.write(_line(asdict(record)))

    def of(self, photographs: Iterable[Path]) -> list[PhotographRecord]:
        """Return the records of some photographs, in their order."""
        return [self.records[str(photograph)] for photograph in photographs]

    def rewrite(self, photographs: Iterable[str]) -> None:
        """Write the settings and the records of some photographs anew, in their order."""
        self.records = {photograph: self.records[photograph] for photograph in photographs}
        entries = [{"settings": self.settings}, *map(asdict, self.records.values())]
        text = "".join(map(_line, entries))
        atomic_write_text(self.path, text, overwrite=True, error=PlateError)

    def _read(self) -> None:
        """Read the records of an earlier run; a last line that was cut short is left out."""
        *lines, _ = self.path.read_bytes().split(b"\n")
        try:
            entries = list(map(parse_json, lines))
            settings = dict(entries[0]["settings"])
            records = list(map(_record, entries[1:]))
        except (ArithmeticError, AttributeError, IndexError, KeyError, TypeError, ValueError) as problem:
            raise PlateError(f"{self.path}: is no manifest; choose another folder, or add --overwrite") from problem
        settings.setdefault(RESPONSE, self.settings.get(RESPONSE))
        if differing := [name for name, value in self.settings.items() if settings.get(name) != value]:
            how = _setting_words(differing[0], settings)
            raise PlateError(f"{self.path}: was begun {how}; give the same, choose another folder, or add --overwrite")
        self.records = {record.photograph: record for record in records}


def check_records(records: Sequence[PhotographRecord]) -> None:
    """Check that no photograph failed.

    Raises
    ------
    PhotoError
        With the number of those that did, and what the first lacks.
    """
    if failed := [record for record in records if record.error]:
        others = " and the others are written" if len(failed) < len(records) else ""
        first = f"the first: {failed[0].error}"
        raise PhotoError(f"{len(failed)} of {len(records)} photographs failed{others}; {first}")


def _setting_words(name: str, settings: Mapping[str, Any]) -> str:
    """Return in the words of the command's options how the settings of an earlier run were in one point."""
    value = settings.get(name)
    if name == RESPONSE:
        return "when the LUT, or the camera, of that name held another response"
    if name in SWITCHES:
        option, stands_for = SWITCHES[name]
        return f"{'with' if value == stands_for else 'without'} {option}"
    option = OPTIONS.get(name, "--" + name.replace("_", "-"))
    if name in ("exposure", "gray"):
        value = settings.get("exposure") if settings.get("gray") is None else f"gray={settings['gray']}"
    return f"with another {option} ({'none' if value is None else value})"


def _record(entry: Mapping[str, Any]) -> PhotographRecord:
    """Return a record of a manifest's line."""
    several = {name: tuple(entry.get(name, ())) for name in ("weights", "warnings")}
    record = PhotographRecord(**{**entry, **several, "exposure": float(entry.get("exposure", 0.0))})
    if not all(isinstance(text, str) for text in (record.photograph, record.folder, record.error, record.plate.name)):
        raise TypeError("a name is no text")
    if any(path.is_absolute() or ".." in path.parts for path in (Path(record.folder), Path(record.linear))):
        raise ValueError("a folder leads elsewhere")  # files there might be replaced
    if (primaries := record.plate.primaries) and not np.isfinite(np.linalg.inv(primaries.to_xyz())).all():
        raise ValueError("these are no primaries")
    return record


def _line(entry: Mapping[str, Any]) -> str:
    """Return a JSON line; what is no text in it, as in a file's name, is escaped as JSON has it."""
    text = json.dumps(entry, ensure_ascii=False) + "\n"
    return text.encode(errors="backslashreplace").decode()
