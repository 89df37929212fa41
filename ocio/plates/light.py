"""The meaning of the numbers in a linear plate, and a check that finished frames have the same."""

from collections.abc import Iterable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np
import OpenImageIO as oiio

from crfnet_core.photograph.image_io import oiio_message
from crfnet_core.photograph.image_io.header_checks import attributes_of
from crfnet_core.photograph.metadata.color_tags import ColorTags
from crfnet_core.response.curve import ResponseCurve

from ..defaults import GRAY_BRIGHTNESS, MIDDLE_GRAY
from ..errors import LutError, PlateError
from ..luts.rgb_lut import AnyLut, lut_identity
from ..options import PlateOptions
from .exr import FORM, is_whole, written_form
from .primaries import LinearSpace, PlatePrimaries, linear_space, plate_primaries

#: Our attributes of OpenEXR files: the plate (see `identities`), the LUT's provenance, the LUT itself, stops, primaries
#: and their source. The last one is the sample type, which is not an attribute.
PLATE, RESPONSE, LUT, EXPOSURE = "crfnet:plate", "crfnet:response", "crfnet:lut", "crfnet:exposure"
PRIMARIES, PRIMARIES_SOURCE, _DEPTH = "crfnet:primaries", "crfnet:primariesSource", "crfnet:depth"

#: Largest difference in stops between exposures that are the same.
SAME_EXPOSURE = 1e-3


@dataclass(frozen=True)
class PlateLight:
    """The meaning of the numbers in a linear plate."""

    lut: AnyLut  # the inverse response
    stops: float  # added after it
    plate: PlatePrimaries
    space: LinearSpace  # of the linear values
    tagged: str = ""  # the published encoding that a tag of the plate names, and the tag

    @classmethod
    def from_tags(cls, tags: ColorTags, lut: AnyLut, options: PlateOptions) -> Self:
        """Return the light of a plate with these tags; raises as `anchored_exposure` and `linear_space`."""
        plate = plate_primaries(tags, options.primaries)
        stops = anchored_exposure(lut, gray=options.gray, stops=options.exposure)
        tagged = f"{tags.transfer} ({tags.transfer_source})" if tags.transfer and not options.is_encoded else ""
        return cls(lut, stops, plate, linear_space(plate, options.output_space), tagged)

    @property
    def attributes(self) -> dict[str, str | float | tuple[float, ...]]:
        """The attributes of the OpenEXR file by name; those that would be empty are left out."""
        attributes: dict[str, str | float | tuple[float, ...]] = {
            "colorInteropID": self.space.interop_id,
            "chromaticities": self.space.chromaticities,
            RESPONSE: " | ".join(self.lut.comments),
            LUT: lut_identity(self.lut),
            EXPOSURE: self.stops,
            PRIMARIES: self.plate.name,
            PRIMARIES_SOURCE: self.plate.source,
        }
        return {name: value for name, value in attributes.items() if value not in ("", ())}


def anchored_exposure(response: ResponseCurve | AnyLut, *, gray: float | None = None, stops: float = 0.0) -> float:
    """Return the stops to add after the inverse response, which leaves the exposure open (Eq. 31 of docs/METHOD.md).

    `gray` is the encoded brightness of a surface that reflects 18 % of the light; by default brightness 1 becomes 1.
    """
    if gray is None:
        return stops
    irradiance = linear_gray(response, gray)
    if irradiance <= 0:
        raise LutError("gray_is_black", gray=gray)
    return float(np.log2(MIDDLE_GRAY / irradiance)) + stops


def linear_gray(response: ResponseCurve | AnyLut, gray: float = GRAY_BRIGHTNESS) -> float:
    """Return the linear value of an encoded brightness, by default that at which cameras place 18 % gray."""
    if isinstance(response, ResponseCurve):
        return float(response.inverse(gray))
    return float(response.channels[len(response.channels) // 2].apply(gray))


def check_finished(plates: Iterable[tuple[Path, str]], light: PlateLight, depth: str) -> None:
    """Raise a PlateError unless each file is the whole linear frame, in this light, of its plate: see `identities`."""
    outdated = []
    for path, plate in plates:
        written = _attributes(path)
        if EXPOSURE not in written:
            raise PlateError("finished_foreign", path=path)
        if written.get(PLATE) != plate:
            outdated.append(path)
        elif difference := _difference(written, light, depth):
            raise PlateError("finished_differs", path=path, difference=difference)
    if outdated:
        more = f", and {len(outdated) - 1} more like it" if outdated[1:] else ""
        raise PlateError("finished_outdated", path=outdated[0], more=more)


def is_finished(path: Path) -> bool:
    """Return whether a file is a whole linear frame."""
    return EXPOSURE in _attributes(path)


def _difference(written: dict[str, Any], light: PlateLight, depth: str) -> str:
    """Return in words how the settings of a finished frame differ; empty if they do not."""
    if written[_DEPTH] != depth:
        return f"{written[_DEPTH]} samples, not {depth}"
    if abs(written[EXPOSURE] - light.stops) > SAME_EXPOSURE:
        return f"an exposure of {round(written[EXPOSURE], 3):+g} stops, not {round(light.stops, 3):+g}"
    for name, words in ((PRIMARIES, "primaries"), ("colorInteropID", "color space")):
        if name in written and written[name] != light.attributes[name]:
            return f"the {words} {written[name]}, not {light.attributes[name]}"
    return "another LUT" if written.get(LUT) != lut_identity(light.lut) else ""


def _attributes(path: Path) -> dict[str, Any]:
    """Return the attributes and the sample type of an OpenEXR file that is whole and as we wrote it, else nothing."""
    source = oiio.ImageInput.open(str(path)) if path.is_file() else None
    if source is None:
        oiio_message()
        return {}
    with closing(source):
        header = source.spec()
        attributes = {name: value for name, _, value in attributes_of(header)}
    is_ours = attributes.get(FORM) == written_form(header) and is_whole(path, header)
    return {**attributes, _DEPTH: str(header.format)} if is_ours else {}
