"""What `crfnet estimate` wrote for a plate, read back: its LUT, its colour space, and its linear plates."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import OpenImageIO as oiio
import PyOpenColorIO as OCIO

from crfnet_core.colorimetry import PHOTOGRAPHIC, REC709, Primaries
from crfnet_core.errors import CRFNetError
from crfnet_core.files import read_json
from crfnet_core.photograph.image_io import oiio_message

from ...defaults import ESTIMATES
from ...errors import ConfigError, LutError
from ...luts.files import WRITERS, read_lut
from ...luts.lut1d import Lut1D
from ...luts.response import response_of_lut
from ...output_files import OutputFiles
from ..files import load_config, plate_exposure
from ..plate_color_space import PlateColorSpace


@dataclass(frozen=True, eq=False)
class Look:
    """The look of a plate's camera.

    Parameters
    ----------
    source : Path
        The document or the LUT that was read, in full: it tells plates of one name apart.
    space : PlateColorSpace
        The plate's colour space, without a file rule; its LUT is a .spi1d file beside the config.
    lut : Lut1D
        The inverse response.
    photographs : tuple of str
        The names of the photographs' files; none if only a LUT is known.
    linear : dict of str to str
        The colour space that each linear plate's header states (`colorInteropID`), by the name of its file; an empty
        text if it states none. Files that are not there any more are left out.
    """

    source: Path
    space: PlateColorSpace
    lut: Lut1D
    photographs: tuple[str, ...]
    linear: dict[str, str]


def read_looks(path: Path) -> list[Look]:
    """Return what `crfnet estimate` wrote.

    Parameters
    ----------
    path : Path
        The folder, with one or several estimates; the JSON document of one; or a LUT file of an inverse response, which
        may come from elsewhere.

    Raises
    ------
    ConfigError
        If there is nothing of the kind.
    LutError
        If a LUT cannot be read, or is none of an inverse response.
    """
    path = path.resolve()
    if path.is_dir():
        pattern = "**/*.json" if (path / ESTIMATES).is_file() else "*.json"
        documents = [found for found in sorted(path.glob(pattern)) if _document(found)]
        if not documents:
            raise ConfigError(f"{path}: holds nothing that crfnet estimate wrote; give its folder, JSON or LUT")
        return [look for document in documents for look in read_looks(document)]
    if path.suffix.lower() in WRITERS:
        return [_look(path, path, _document(path.with_suffix(".json")))]
    document = _document(path)
    if document is None:
        raise ConfigError(f"{path}: is no document of crfnet estimate; give its folder, JSON or LUT")
    return [_look(path, path.with_name(document["files"]["spi1d"]), document)]


def _look(source: Path, lut_file: Path, document: dict[str, Any] | None) -> Look:
    """Return the look of a LUT, with all that its document says."""
    photographs = tuple(photo["name"] for photo in document["photographs"]) if document else ()
    names = Path(photographs[0] if photographs else lut_file.name)
    files = OutputFiles.named(source.parent, [names])
    space = files.plate_color_space(names)
    if document:
        space = replace(space, exposure=_exposure(source, document), primaries=_primaries(document))
    linear = [source.with_name(name) for name in document["files"]["linear"]] if document else [*files.linear]
    headers = {file.name: _interop_id(file) for file in linear if file.is_file()}
    return Look(source.with_suffix(""), space, _inverse_response(lut_file), photographs, headers)


def _inverse_response(path: Path) -> Lut1D:
    """Return the LUT of an inverse response; raise a LutError if it is another kind of LUT."""
    lut = read_lut(path)
    try:
        response_of_lut(lut)
    except CRFNetError as problem:
        raise LutError(f"{path}: {problem}") from problem
    assert isinstance(lut, Lut1D)  # others have no response
    return lut


def _document(path: Path) -> dict[str, Any] | None:
    """Return the document of an estimate, or None if the file is absent or something else."""
    try:
        document = read_json(path)
        names = [document["color_space"], *(photo["name"] for photo in document["photographs"])]
        names += [document["files"][kind] for kind in ("spi1d", "config")] + document["files"]["linear"]
        float(document["exposure"]["stops"])
        _primaries(document)
    except (OSError, KeyError, OverflowError, TypeError, ValueError):
        return None
    return document if all(isinstance(name, str) and name and Path(name).name == name for name in names) else None


def _exposure(source: Path, document: dict[str, Any]) -> float:
    """Return the stops of a plate: those in the look's own config, where they may have been edited, or the document."""
    config = source.with_name(document["files"]["config"])
    space: OCIO.ColorSpace | None = None
    if config.is_file():
        space = load_config(config).getColorSpace(document["color_space"])
    return plate_exposure(space) if space is not None else float(document["exposure"]["stops"])


def _primaries(document: dict[str, Any]) -> Primaries:
    """Return the primaries of a plate; unknown ones are taken for Rec.709."""
    entry = document["primaries"]
    if "red" not in entry:
        return REC709
    red, green, blue, white = ((float(x), float(y)) for x, y in map(entry.get, ("red", "green", "blue", "white")))
    found = Primaries(str(entry["name"]), red, green, blue, white)
    known = (each for each in PHOTOGRAPHIC.values() if replace(each, name=found.name, interop_id="") == found)
    return next(known, found)


def _interop_id(path: Path) -> str:
    """Return the colour space that an image's header states, by its name in the Color Interop Forum's list."""
    image = oiio.ImageInput.open(str(path))
    if image is None:
        oiio_message()
        return ""
    name = image.spec().get_string_attribute("colorInteropID")
    image.close()
    return str(name)
