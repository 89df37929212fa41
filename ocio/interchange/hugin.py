"""The response of a Hugin project: five EMoR parameters, Ra to Re, in the line of each image.

Hugin's table is `emor.txt` of Columbia's CAVE: a mean response, and components in the order of their variance. Our
basis comes from the same 201 curves by another computation, so the components agree but for their signs and a few
hundredths; the mean differs by up to 0.004. `HUGIN_BASIS` says where Hugin's mean and its first five components lie in
ours. With it the two responses agree to about 4e-4 of the brightness range (at most 1.2e-3 in 200 drawn ones), where
signs alone leave 5e-3.

Source: Grossberg & Nayar, "Modeling the space of camera response functions", TPAMI 2004; the parameters of i-lines:
Hugin, `hugin_base/panodata/image_variables.h`.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from crfnet_core.files import atomic_write
from crfnet_core.response.emor import EmorBasis
from crfnet_core.types import Float64Array

from ..errors import LutError
from ..luts.response import brightness_samples
from ..luts.rgb_lut import AnyLut
from ..luts.text import LutText
from .response_file import ResponseFile, from_curve

#: Hugin's mean, less our mean, and its five components, as weights of our eleven: emor.txt projected on our basis.
HUGIN_BASIS = (
    (0.07299, 0.04424, -0.01234, 0.00036, -0.00090, 0.00078, 0.00198, -0.00227, 0.00081, -0.00073, -0.00132),
    (-0.99995, -0.00882, 0.00459, -0.00123, -0.00025, -0.00000, -0.00027, 0.00029, -0.00027, 0.00016, 0.00006),
    (-0.00886, 0.99990, -0.00932, -0.00593, -0.00182, 0.00010, 0.00042, -0.00039, -0.00048, 0.00027, -0.00008),
    (-0.00452, -0.00928, -0.99984, 0.01221, 0.00308, -0.00475, -0.00117, 0.00455, -0.00083, 0.00125, -0.00022),
    (-0.00124, 0.00602, 0.01204, 0.99946, 0.00342, 0.01034, 0.02232, -0.00956, 0.00121, 0.00104, -0.01126),
    (0.00023, -0.00185, -0.00324, 0.00243, -0.99903, 0.01434, 0.02914, -0.02189, -0.00684, -0.01730, -0.00528),
)

NAMES = ("Ra", "Rb", "Rc", "Rd", "Re")

_IMAGE_LINE = re.compile(r"^i .*", re.MULTILINE)

_PARAMETER = re.compile(r"(?<=\s)(R[a-e])(=?)(-?[0-9][0-9.]*(?:[eE][-+]?[0-9]+)?)(?=\s|$)")


def hugin_response(parameters: Float64Array) -> Float64Array:
    """Return the brightness at 1024 uniform irradiances, shape (1024,), of parameters of shape (5,).

    As in Hugin, what exceeds white becomes white, and what falls stays level.
    """
    mean, *components = np.array(HUGIN_BASIS)
    samples = EmorBasis.load().reconstruct(mean + np.asarray(parameters) @ np.array(components))
    return np.asarray(np.maximum.accumulate(np.minimum(samples, samples[-1])))


def hugin_parameters(brightness: Float64Array) -> Float64Array:
    """Return the parameters, shape (5,), nearest to a response at 1024 uniform irradiances, in least squares."""
    mean, *components = np.array(HUGIN_BASIS)
    basis = EmorBasis.load()
    offset = brightness - basis.reconstruct(mean)
    return np.asarray(np.linalg.lstsq((np.array(components) @ basis.components).T, offset, rcond=None)[0])


def read_hugin(path: Path, *, curve: str = "") -> ResponseFile:
    """Return the response of the images of a Hugin project (.pto).

    Parameters
    ----------
    path : Path
        The project.
    curve : str
        The number of the image, from 0 as in Hugin; needed where the images differ.

    Raises
    ------
    LutError
        If it is absent or no project, or its images differ in their responses.
    """
    source = LutText.read(path)
    images = _image_parameters(source)
    if curve and not (curve.isdecimal() and int(curve) < len(images)):
        raise source.error(f"has no image {curve!r}; name one of 0 to {len(images) - 1}")
    chosen = images[int(curve or 0)]
    other = next((number for number, image in enumerate(images) if image != chosen), None)
    if not curve and other is not None:
        raise source.error(f"images 0 and {other} have different responses; choose with crfnet convert --curve {other}")
    named = " ".join(f"{name} {value:g}" for name, value in zip(NAMES, chosen, strict=True))
    notes = [named if any(chosen) else f"{named}: Hugin's default, the mean of many cameras, so nothing was measured"]
    return from_curve(path, hugin_response(np.array(chosen)), "Hugin's EMoR parameters", notes)


def write_hugin(path: Path, lut: AnyLut, *, overwrite: bool = False) -> tuple[str, ...]:
    """Set the response of all images of an existing Hugin project, and return in words how well five parameters do.

    The rest of the project stays as it is, byte for byte. An image whose parameters are linked to another's keeps the
    link.

    Raises
    ------
    LutError
        If there is no such project, it may not be changed, or the LUT treats the channels apart.
    """
    if not path.exists():
        raise LutError(f"{path}: there is no such project; save one in Hugin first, its images get the response")
    if len(lut.channels) > 1:
        raise LutError(f"{path}: Hugin has one response for R, G and B; give one that treats the channels alike")
    source = LutText.read(path)
    _image_parameters(source)
    brightness = brightness_samples(lut.channels[0])
    parameters = hugin_parameters(brightness)
    values = dict(zip(NAMES, parameters.tolist(), strict=True))

    def changed(match: re.Match[str]) -> str:
        return match[0] if match[2] else f"{match[1]}{values[match[1]]:.9g}"

    def changed_line(line: re.Match[str]) -> str:
        variables, quote, name = line[0].partition(' n"')
        return _PARAMETER.sub(changed, variables) + quote + name

    text = path.read_bytes().decode("latin-1")  # names of images may be in any encoding: this one keeps every byte
    with atomic_write(path, overwrite=overwrite, error=LutError) as temporary:
        temporary.write_bytes(_IMAGE_LINE.sub(changed_line, text).encode("latin-1"))
    error = np.sqrt(np.mean((hugin_response(parameters) - brightness) ** 2))
    named = ", ".join(f"{name}={value:.4g}" for name, value in values.items())
    return (f"{named}: off by {100 * error:.2g} % of the brightness range (RMS)",)


def _image_parameters(source: LutText) -> list[tuple[float, ...]]:
    """Return the parameters of each image, with links followed."""
    found = [
        {match[1]: (match[2], match[3]) for match in _PARAMETER.finditer(line.partition(' n"')[0])}
        for line in source.lines
        if line.startswith("i ")
    ]
    if not found or not all(image.keys() == set(NAMES) for image in found):
        raise source.error("has no images with Ra to Re; give a project of Hugin (.pto)")
    by_number = {str(number): image for number, image in enumerate(found)}
    images = []
    for number, image in enumerate(found):
        values = []
        for name in NAMES:
            link, text = image[name]
            if link:
                named = text
                link, text = by_number.get(named, {}).get(name, ("=", ""))
                if link:
                    problem = f"image {number} takes {name} from image {named[:24]}, which has none of its own"
                    raise source.error(f"{problem}; save the project again in Hugin")
            values += source.numbers(text, None, count=1)
        images.append(tuple(values))
    return images
