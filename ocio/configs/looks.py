"""The files that an estimate wrote for a plate, read back: its LUT and its color space."""

import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from crfnet_core.colorimetry import PHOTOGRAPHIC, REC709, Primaries
from crfnet_core.errors import CRFNetError
from crfnet_core.files import read_json
from crfnet_core.types import number_of

from ..defaults import ESTIMATES, MOST_STOPS
from ..errors import ConfigError, LutError
from ..luts.files import WRITERS, read_lut
from ..luts.lut1d import Lut1D
from ..luts.response import response_of_lut
from ..output_files import OutputFiles
from .file_rules import plate_pattern
from .files import load_config, plate_exposure
from .plate_color_space import PlateColorSpace
from .reference_space import LINEAR_NAMES

#: Ends the name of a movie as a photograph: clip.mp4 frame 1.
MOVIE_FRAME = re.compile(r" frame \d+$")


@dataclass(frozen=True, eq=False)
class Look:
    """The color space of a plate, its LUT (a .spi1d file next to the config), and the name of its folder."""

    space: PlateColorSpace
    lut: Lut1D
    folder: str  # sets it apart from other plates of the name


def read_looks(path: Path) -> list[Look]:
    """Return the looks in a folder of one or several estimates, a JSON document, or a LUT file of an inverse response.

    Raise a ConfigError if there is no estimate, and a LutError if a LUT cannot be read or is not an inverse response.
    """
    path = path.resolve()
    if path.is_dir():
        pattern = "**/*.json" if (path / ESTIMATES).is_file() else "*.json"
        documents = [file for file in sorted(path.glob(pattern)) if _document(file)]
        if not documents:
            raise ConfigError("folder_without_look", path=path)
        return [look for document in documents for look in read_looks(document)]
    if path.suffix.lower() in WRITERS:
        return [_look(path, _document(path.with_suffix(".json")))]
    document = _document(path)
    if document is None:
        raise ConfigError("not_a_look", path=path)
    return [_look(path.with_name(document["files"]["spi1d"]), document)]


def _look(lut_file: Path, document: dict[str, Any] | None) -> Look:
    """Return the look of a LUT, with all that its document states."""
    folder = lut_file.parent
    if document:
        names = [MOVIE_FRAME.sub("", photo["name"]) for photo in document["photographs"]]
        photo, sequence = Path(names[0]), document.get("sequence", "")
        files = OutputFiles.named(folder, [photo])
        files = replace(files, linear=tuple(folder / name for name in document["files"]["linear"]))
        space = replace(
            PlateColorSpace.from_outputs(files, photo, exposure=_exposure(folder, document), file_pattern=sequence),
            file_patterns=tuple(dict.fromkeys([sequence] if sequence else map(plate_pattern, names))),
            primaries=_primaries(document),
            linear_primaries=_linear_primaries(document),
        )
    else:
        space = PlateColorSpace.from_outputs(OutputFiles.named(folder, [lut_file]), lut_file)
        space = replace(space, file_patterns=(), linear_patterns=())
    return Look(space, _inverse_response(lut_file), folder.name)


def _inverse_response(path: Path) -> Lut1D:
    """Return the LUT of an inverse response; raise a LutError if it is another kind of LUT."""
    lut = read_lut(path)
    try:
        response_of_lut(lut)
    except CRFNetError as problem:
        raise LutError("lut_without_inverse_response", path=path, reason=problem) from problem
    assert isinstance(lut, Lut1D)  # others have no response
    return lut


def _document(path: Path) -> dict[str, Any] | None:
    """Return the document of an estimate, or None if the file is absent or something else; refuse one kept secret."""
    try:
        document = read_json(path)
        names = [document["color_space"], *(photo["name"] for photo in document["photographs"])]
        names += [document["files"][kind] for kind in ("spi1d", "config")] + document["files"]["linear"]
        names += [document["sequence"]] if "sequence" in document else []
        number_of(document["exposure"]["stops"], least=-MOST_STOPS, most=MOST_STOPS)
        _primaries(document)
        _linear_primaries(document)
        is_named = all(isinstance(name, str) and _is_file_name(name) for name in names)
    except PermissionError as problem:
        raise ConfigError("not_opened", path=path, reason=problem.strerror) from problem
    except (OSError, KeyError, ArithmeticError, TypeError, ValueError):
        return None
    return document if is_named and document["photographs"] else None


def _is_file_name(name: str) -> bool:
    """Return whether a text is the name of a file, without a folder; ValueError if it has a surrogate."""
    return "\0" not in name and 0 < len(name.encode()) < 250 and Path(name).name == name


def _exposure(folder: Path, document: dict[str, Any]) -> float:
    """Return the stops of a plate: those in the look's config, where they may have been edited, or the document."""
    config = folder / document["files"]["config"]
    space = load_config(config).getColorSpace(document["color_space"]) if config.is_file() else None
    return plate_exposure(space) if space is not None else float(document["exposure"]["stops"])


def _primaries(document: dict[str, Any]) -> Primaries:
    """Return the primaries of a plate; unknown ones are taken for Rec.709."""
    entry = document["primaries"]
    if "red" not in entry:
        return REC709
    primaries = Primaries.from_dict(entry)
    known = (each for each in PHOTOGRAPHIC.values() if replace(each, name=primaries.name, interop_id="") == primaries)
    return next(known, primaries)


def _linear_primaries(document: dict[str, Any]) -> Primaries | None:
    """Return the primaries of the plate's linear files, by the Color Interop Forum's name; None if it is not known."""
    name = document["output_space"]["interop_id"]
    return next((primaries for primaries in LINEAR_NAMES if name and primaries.interop_id == name), None)
