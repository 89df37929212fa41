"""OpenColorIO config files: load one of bounded size; write one after OpenColorIO has checked it against its LUTs."""

import os
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
import PyOpenColorIO as OCIO
from numpy.typing import NDArray

from crfnet_core.files import atomic_write, check_utf8, read_bytes
from crfnet_core.types import Float32Array

from ..errors import ConfigError
from ..luts.lut1d import Lut1D
from .reference_space import rec709_to_reference, steps_to_reference

#: Bytes of the largest config that is read; the ACES configs have less than 1 MB. OpenColorIO takes up to 250 times as
#: much memory, and the square of the number of color spaces in time.
MAX_CONFIG_SIZE = 2 * 2**20

#: The most YAML aliases (`*name`) of a config. OpenColorIO writes none; aliases of aliases multiply to gigabytes.
MOST_ALIASES = 8

#: The most color spaces and named transforms: OpenColorIO takes 8 s for 4000, and four times as long for twice as many.
MOST_SPACES = 2500

#: The most variables of a config, and characters that one may expand to: variables of variables multiply, too.
MOST_VARIABLES, LONGEST_VALUE = 100, 4096

#: The tags of color spaces; and the names of YAML's anchors and aliases, which stand behind these characters.
_SPACE, _ANCHOR, _ALIAS = "!<(?:ColorSpace|NamedTransform)>", r"&([^\s\[\]{},]+)", r"\*([^\s\[\]{},]+)"

#: Largest difference between a config's processor and the LUT, absolute up to a value of 1, relative above; and the
#: number of brightnesses at which they are compared.
TOLERANCE, CHECKED_VALUES = 1e-5, 4096

#: Variables by which OpenColorIO shows a part of every config only.
HIDING_VARIABLES = ("OCIO_ACTIVE_DISPLAYS", "OCIO_ACTIVE_VIEWS", "OCIO_INACTIVE_COLORSPACES")


def load_config(path: str | Path) -> OCIO.Config:
    """Return the config in a file of at most `MAX_CONFIG_SIZE` bytes, `MOST_ALIASES` aliases and `MOST_SPACES` spaces.

    Raise a ConfigError if it is absent, larger, not UTF-8, its variables multiply, a LUT of it is a device or pipe, or
    OpenColorIO refuses it.
    """
    path = Path(path)
    if not os.path.lexists(path):
        raise ConfigError("no_such_file", path=path)
    check_utf8(path, ConfigError)
    try:
        text = read_bytes(path, most=MAX_CONFIG_SIZE).decode().replace("\0", "")  # of UTF-16
        anchors = set(re.findall(_ANCHOR, text))
        aliases = [name for name in re.findall(_ALIAS, text) if name in anchors]  # others are stars of a comment
        bounded = {"YAML aliases": (aliases, MOST_ALIASES), "color spaces": (re.findall(_SPACE, text), MOST_SPACES)}
        for kind, (found, most) in bounded.items():
            if len(found) > most:
                raise ConfigError("config_too_many", path=path, most=most, kind=kind)
        config = OCIO.Config.CreateFromFile(str(path))
        values = {name: config.getEnvironmentVarDefault(name) for name in config.getEnvironmentVarNames()}
        if len(values) > MOST_VARIABLES or not all(_is_bounded(value, values) for value in values.values()):
            raise ConfigError("config_variables", path=path, most=MOST_VARIABLES)
        _check_files(path, config)
        return config
    except OSError as problem:
        raise ConfigError("config_unreadable", path=path, reason=problem.strerror or problem) from None
    except UnicodeDecodeError:  # Python cannot show the names in it, nor OpenColorIO's messages
        raise ConfigError("config_unreadable", path=path, reason="it is not UTF-8 text") from None
    except (OCIO.Exception, OCIO.ExceptionMissingFile) as problem:
        raise ConfigError("config_refused", path=path, reason=problem) from None


def _check_files(path: Path, config: OCIO.Config) -> None:
    """Refuse a config with a LUT that is not a file, such as a device, which may have no end; absent ones may be."""
    both = OCIO.COLORSPACE_DIR_TO_REFERENCE, OCIO.COLORSPACE_DIR_FROM_REFERENCE
    spaces = config.getColorSpaces(OCIO.SEARCH_REFERENCE_SPACE_ALL, OCIO.COLORSPACE_ALL)
    waiting = [space.getTransform(direction) for space in spaces for direction in both]
    while waiting:
        transform = waiting.pop()
        if isinstance(transform, OCIO.GroupTransform):
            waiting += transform
        if isinstance(transform, OCIO.FileTransform):
            with suppress(OCIO.Exception, OCIO.ExceptionMissingFile):
                file = Path(config.getCurrentContext().resolveFileLocation(transform.getSrc()))
                if file.exists() and not file.is_file():
                    raise ConfigError("config_reads_device", path=path, file=file)


def _is_bounded(text: str, values: Mapping[str, str]) -> bool:
    """Return whether a text has at most `LONGEST_VALUE` characters as its variables are replaced again and again."""
    names = "|".join(map(re.escape, sorted(values, key=len, reverse=True)))
    for _ in range(MOST_VARIABLES):
        text = re.sub(
            rf"\$\{{({names})\}}|\$({names})|%({names})%", lambda match: values[match[match.lastindex or 0]], text
        )
        if len(text) > LONGEST_VALUE:
            return False
    return True


def write_config(path: str | Path, config: OCIO.Config, *, check: Mapping[str, Lut1D], overwrite: bool = False) -> None:
    """Write a config; the file gets its name only after OpenColorIO has loaded it and converts as its LUTs do.

    `check` holds the LUT of each plate's color space, by its name: the processor must equal the LUT, times the
    exposure, in both directions to `TOLERANCE`. Raise a ConfigError, and leave no file, if it does not, the config is
    not valid, or it cannot be written.
    """
    OCIO.ClearAllCaches()
    try:
        with _whole_configs(), atomic_write(path, overwrite=overwrite, error=ConfigError) as temporary:
            text = str(config.serialize())
            if config.getEnvironmentMode() == OCIO.ENV_ENVIRONMENT_LOAD_ALL:  # OpenColorIO declares that there are none
                text = text.replace("environment:\n  {}\n", "", 1)
            temporary.write_text(text, encoding="utf-8", newline="\n")
            loaded = OCIO.Config.CreateFromFile(str(temporary))
            loaded.setWorkingDir(str(Path(path).parent))  # where its LUTs lie
            loaded.validate()
            for name, lut in check.items():
                difference = _conversion_error(loaded, name, lut)
                if not difference <= TOLERANCE:
                    raise ConfigError("config_differs_from_lut", name=name, difference=difference)
    except (OCIO.Exception, OCIO.ExceptionMissingFile) as problem:
        raise ConfigError("config_invalid", path=path, reason=problem) from problem


@contextmanager
def _whole_configs() -> Iterator[None]:
    """Lift the variables by which a studio hides displays, views and spaces: configs without these are not valid."""
    hidden = {name: os.environ.pop(name) for name in HIDING_VARIABLES if name in os.environ}
    try:
        yield
    finally:
        os.environ.update(hidden)


def _conversion_error(config: OCIO.Config, name: str, lut: Lut1D) -> float:
    """Return the largest difference between a color space and its LUT, in both directions and beyond both ends."""
    space = config.getColorSpace(name)
    if space is None:
        raise ConfigError("color_space_absent", name=name)
    low, high = lut.domain
    margin = (high - low) / 8
    brightness = np.linspace(low - margin, high + margin, CHECKED_VALUES, dtype=np.float32)
    linear = OCIO.ColorSpace(name="crfnet check", toReference=OCIO.GroupTransform(rec709_to_reference(config)))
    config.addColorSpace(linear)
    gain = np.float32(2 ** plate_exposure(space))
    expected = lut.apply(brightness) * gain
    irradiance = _converted(config, name, linear.getName(), brightness)
    back = _converted(config, linear.getName(), name, expected)
    scale = np.maximum(np.abs(expected), 1)
    forward = np.abs(irradiance - expected) / scale
    # The inverse of a flat part is not determined in float32, so a brightness also passes if it gives the irradiance.
    backward = np.minimum(np.abs(back - lut.apply_inverse(expected / gain)), np.abs(lut.apply(back) * gain - expected))
    return max(float(forward.max()), float((backward / scale).max()))


def plate_exposure(space: OCIO.ColorSpace) -> float:
    """Return the stops that a plate's color space adds after its LUT."""
    steps = (step for step in steps_to_reference(space) if isinstance(step, OCIO.ExposureContrastTransform))
    return sum(float(step.getExposure()) for step in steps)


def _converted(config: OCIO.Config, source: str, target: str, values: NDArray[np.floating]) -> Float32Array:
    """Return gray pixels, shape (N,), converted from one color space to another."""
    pixels = np.repeat(values.astype(np.float32), 3)
    config.getProcessor(source, target).getOptimizedCPUProcessor(OCIO.OPTIMIZATION_NONE).applyRGB(pixels)
    return pixels[::3]
