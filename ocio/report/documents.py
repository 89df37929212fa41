"""Estimates, plates and LUTs as documents: mappings ready for JSON."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from crfnet_core.colorimetry import CORNERS
from crfnet_core.estimate.result import ResponseEstimate
from crfnet_core.library import Camera

from ..defaults import GRAY_BRIGHTNESS, MIDDLE_GRAY
from ..luts.response import ResponseFile
from ..output_files import OutputFiles
from ..plates.light import PlateLight, linear_gray
from ..plates.linear import PlateReport
from .facts import PhotoEntry

#: Decimals kept in the documents of LUTs.
DECIMALS = 6

#: Brightnesses whose irradiance is shown of a LUT.
QUARTERS = (0.25, 0.5, 0.75)


def estimate_document(
    estimate: ResponseEstimate, photos: Sequence[PhotoEntry], files: OutputFiles, light: PlateLight
) -> dict[str, Any]:
    """Return an estimate (`to_dict`), its photographs and its files, named relative to the folder, ready for JSON."""
    return {
        **estimate.to_dict(),
        "photographs": [vars(photo) for photo in photos],
        **_light_document(light),
        "color_space": files.color_space,
        "files": file_names(files),
    }


def plate_document(report: PlateReport, estimate: ResponseEstimate | None) -> dict[str, Any]:
    """Return which frames were written, and the estimate if one was made from them, ready for JSON."""
    return {
        "written": [str(path) for path in report.written],
        "skipped": [str(path) for path in report.skipped],
        "missing": list(report.missing),
        "clipped": rounded(report.clipped),
        **_light_document(report.light),
        "tagged": report.light.tagged or None,
        "estimate": estimate.to_dict() if estimate else None,
    }


def lut_document(response: ResponseFile) -> dict[str, Any]:
    """Return the contents of a LUT file, ready for JSON."""
    lut = response.table
    quarters = [channel.apply(np.array(QUARTERS)) for channel in lut.channels]
    return {
        "kind": "lut",
        "file": response.path.name,
        "response": response.words,
        "direction": "forward" if response.was_forward else "inverse",
        "channels": len(lut.channels),
        "converts": ["irradiance", "brightness"] if response.was_forward else ["brightness", "irradiance"],
        "length": len(lut.values),
        "domain": rounded(lut.domain),
        "range": rounded([lut.values[0].min(), lut.values[-1].max()]),
        "at_quarters": rounded(quarters[0] if len(quarters) == 1 else quarters),
        "provenance": list(lut.comments),
    }


def camera_summary(camera: Camera) -> dict[str, Any]:
    """Return a camera in short, ready for JSON."""
    settings = asdict(camera.settings) | {"iso": list(camera.settings.iso)}
    return {"name": camera.name, **settings, "basis": camera.basis}


def _light_document(light: PlateLight) -> dict[str, Any]:
    """Return the primaries, the exposure and the space of linear plates, ready for JSON."""
    primaries, gray = light.plate.primaries, linear_gray(light.lut)
    return {
        "primaries": {
            "name": light.plate.name,
            "source": light.plate.source,
            **({corner: rounded(getattr(primaries, corner)) for corner in CORNERS} if primaries else {}),
        },
        "exposure": {
            "stops": rounded(light.stops),
            "gray_brightness": GRAY_BRIGHTNESS,
            "gray_linear": rounded(gray * 2**light.stops),
            "gray_stops": rounded(np.log2(MIDDLE_GRAY / gray)) if gray > 0 else None,
        },
        "output_space": {"name": str(light.space), "interop_id": light.space.interop_id},
    }


def file_names(files: OutputFiles) -> dict[str, str | list[str] | None]:
    """Return the file names by kind."""
    return {
        **{path.suffix[1:]: path.name for path in files.luts},
        "forward": [path.name for path in files.forward],
        "config": files.config.name,
        "linear": [path.name for path in files.linear],
        "sheet": files.sheet.name if files.sheet else None,
        "report": files.report.name,
    }


def rounded(values: ArrayLike | Mapping[str, ArrayLike]) -> Any:
    """Return a number, nested lists of numbers, or numbers by name, rounded to `DECIMALS` decimals."""
    if isinstance(values, Mapping):
        return {name: rounded(value) for name, value in values.items()}
    return np.round(np.asarray(values, dtype=np.float64), DECIMALS).tolist()
