"""LUT files as OpenColorIO reads them, so that a file means here what it means in every host."""

import re
from pathlib import Path

import numpy as np
import PyOpenColorIO as OCIO

from crfnet_core.errors import check_kinds, one_line
from crfnet_core.files import check_utf8, read_bytes
from crfnet_core.types import Float64Array

from ..errors import LutError
from .lut1d import MAX_LENGTH, strictly_increasing
from .rgb_lut import AnyLut, lut_of_columns

#: Size in bytes of the largest LUT file that is read; a table for each channel of the largest length takes 3 MB.
MAX_FILE_SIZE = 4 * 2**20

#: The suffixes of the formats that OpenColorIO reads.
READABLE = tuple(sorted({f".{suffix}" for _, suffix in OCIO.FileTransform.getFormats()}))

#: The elements of XML by which a LUT file reads others, devices among them, or hides that it does.
OTHER_FILES = re.compile("<Reference|<!DOCTYPE", re.IGNORECASE)

#: Largest part of the steps of a table that may be level, as integers are in the blacks; decimal commas make more.
MOST_LEVEL = 0.5

#: Largest change of a value by which level steps become rising ones, as a part of the range of the table.
MOST_RAISED = 1e-5


def read_lut(path: str | Path) -> AnyLut:
    """Return the 1D LUT in a file of any format that OpenColorIO reads.

    A file of one table keeps its entries; one of several steps, such as a shaper before the table, is sampled at
    `MAX_LENGTH` uniform inputs over its domain. Level steps rise by the least that float32 holds.

    Parameters
    ----------
    path : str or Path
        The file, of at most `MAX_FILE_SIZE` bytes; its suffix is one of `READABLE`, in lower or upper case.

    Raises
    ------
    LutError
        If the file is absent or too large, OpenColorIO refuses it, it mixes the channels, or its table falls anywhere
        or is level over more than `MOST_LEVEL` of its steps.
    """
    check_kinds(path=(path, str | Path))
    path = Path(path)
    text = _checked_text(path)
    comments = [line[1:] for line in map(str.strip, text.split("\n")) if line.startswith("#")]
    processor = _processor(path)
    comments = comments or [child.getElementValue() for child in processor.getFormatMetadata().getChildElements()]
    steps = list(processor.createGroupTransform())
    _check_steps(path, steps)
    _check_rows(path, text, steps)
    domain = _domain(steps[0])
    rest = steps[1:] if domain else steps
    domain = domain or (0.0, 1.0)
    table = np.reshape(rest[0].getData(), (-1, 3)) if len(rest) == 1 else _sampled(steps, domain)
    table = _raised(path, table.astype(np.float64))
    try:
        return lut_of_columns(table, domain, comments)
    except LutError as problem:
        raise LutError("lut_invalid", path=path, problem=problem) from problem


def _checked_text(path: Path) -> str:
    """Return the text of a file; raise a LutError if it is absent, too large, endless, or reads others."""
    try:
        content = read_bytes(path, most=MAX_FILE_SIZE)
    except OSError as problem:
        raise LutError("lut_unreadable", path=path, reason=problem.strerror or problem) from problem
    if path.suffix.lower() not in READABLE:
        raise LutError("lut_suffix", path=path, suffixes=", ".join(READABLE))
    text = content.decode("utf-8", errors="replace")
    if OTHER_FILES.search(text.replace("\0", "")):  # in UTF-16, too
        raise LutError("lut_refused", path=path, reason="it may name other files")
    begin = re.search(r"(?im)^.*BEGIN METADATA", text)
    if begin and not re.search(r"(?im)^[^\S\n]*END METADATA", text[begin.start() :]):
        raise LutError("lut_refused", path=path, reason="no line END METADATA")  # OpenColorIO would look for ever
    return text


def _processor(path: Path) -> OCIO.Processor:
    """Return OpenColorIO's processor of a file, or raise a LutError with its reason."""
    check_utf8(path, LutError)
    OCIO.ClearAllCaches()
    context = OCIO.Context()
    context.setEnvironmentMode(OCIO.ENV_ENVIRONMENT_LOAD_PREDEFINED)  # a $ in a file's name is not a variable
    transform = OCIO.FileTransform(src=str(path.absolute()), interpolation=OCIO.INTERP_LINEAR)
    try:
        return OCIO.Config.CreateRaw().getProcessor(context, transform, OCIO.TRANSFORM_DIR_FORWARD)
    except UnicodeError:  # OpenColorIO's message quotes the file
        raise LutError("lut_refused", path=path, reason="not a text") from None
    except (OCIO.Exception, OCIO.ExceptionMissingFile) as problem:
        reason = one_line(problem).rpartition(" failed with: ")[2].replace(str(path.absolute()), path.name)
        raise LutError("lut_refused", path=path, reason=reason) from None


def _check_steps(path: Path, steps: list[OCIO.Transform]) -> None:
    """Raise a LutError unless the steps hold a table and keep the channels apart."""
    names = {
        OCIO.Lut1DTransform: "a table that adjusts hues or has half floats for inputs",
        OCIO.Lut3DTransform: "a 3D LUT",
    }
    others = [names.get(type(step), type(step).__name__) for step in steps if not _keeps_channels(step)]
    if others or not any(isinstance(step, OCIO.Lut1DTransform) for step in steps):
        raise LutError("lut_not_1d", path=path, steps=", ".join(others) or "no table")


def _check_rows(path: Path, text: str, steps: list[OCIO.Transform]) -> None:
    """Raise a LutError for more rows than the file states, where OpenColorIO leaves them out in silence."""
    suffix, lengths = path.suffix.lower(), [step.getLength() for step in steps if isinstance(step, OCIO.Lut1DTransform)]
    table = re.split(r"(?m)^[ \t]*\d+[ \t]*\r?$", text)[-1] if suffix == ".csp" else text  # there, behind its length
    rows = re.findall(r"(?m)^[ \t]*[-+.\d][-+.\deE \t]*\r?$", table)
    if suffix in (".csp", ".cube", ".spi1d") and len(rows) > lengths[-1]:
        raise LutError("lut_rows", path=path, rows=len(rows), length=lengths[-1])


def _keeps_channels(step: OCIO.Transform) -> bool:
    """Return whether a step computes each channel from itself alone, and scales all alike."""
    if isinstance(step, OCIO.MatrixTransform):
        scale, offset = step.getMatrix()[0], step.getOffset()[0]
        alike = np.array_equal(np.reshape(step.getMatrix(), (4, 4))[:3, :3], scale * np.eye(3))
        return bool(alike and scale and step.getOffset()[:3] == [offset] * 3)
    if isinstance(step, OCIO.Lut1DTransform):
        return not step.getInputHalfDomain() and step.getHueAdjust() == OCIO.HUE_NONE
    return isinstance(step, OCIO.RangeTransform)


def _domain(step: OCIO.Transform) -> tuple[float, float] | None:
    """Return the inputs that a step scales to 0 and 1; None if it is not there to scale a domain."""
    if isinstance(step, OCIO.MatrixTransform):
        scale, offset = step.getMatrix()[0], step.getOffset()[0]
        return -offset / scale, (1 - offset) / scale
    if isinstance(step, OCIO.RangeTransform) and (step.getMinOutValue(), step.getMaxOutValue()) == (0, 1):
        return step.getMinInValue(), step.getMaxInValue()
    return None


def _sampled(steps: list[OCIO.Transform], domain: tuple[float, float]) -> Float64Array:
    """Return the outputs of steps at uniform inputs, shape (65536, 3)."""
    ramp = np.repeat(np.linspace(*domain, MAX_LENGTH, dtype=np.float32), 3)
    processor = OCIO.Config.CreateRaw().getProcessor(OCIO.GroupTransform(steps))
    processor.getOptimizedCPUProcessor(OCIO.OPTIMIZATION_NONE).applyRGB(ramp)
    return ramp.astype(np.float64).reshape(-1, 3)


def _raised(path: Path, table: Float64Array) -> Float64Array:
    """Return a table whose level steps rise; raise a LutError if it falls, is not finite, or is level too often."""
    with np.errstate(invalid="ignore"):
        rises = np.diff(table, axis=0)
    faults = ~(np.isfinite(table[1:]) & np.isfinite(table[:-1]) & (rises >= 0)).all(axis=1)
    if not faults.any() and (rises > 0).mean(axis=0).min() >= 1 - MOST_LEVEL:
        raised = np.stack([strictly_increasing(column) for column in table.T], axis=1)
        if np.abs(raised - table).max() <= MOST_RAISED * np.ptp(table):
            return raised
    faults |= (rises <= 0).any(axis=1)
    raise LutError("lut_not_increasing", path=path, entry=1 + int(np.argmax(faults)))
