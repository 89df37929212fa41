"""OpenCV's calibrated responses: 256 x 1 x 3 float32, as CalibrateDebevec and CalibrateRobertson give them.

The value at a code is the light that makes it, so the response is an inverse one. OpenCV's channels are in the order of
its pictures, which is B, G, R after `cv2.imread`; that order is expected here and written. numpy.save gives .npy,
`cv2.FileStorage` .yml and .xml.

Source: OpenCV, `modules/photo/src/calibrate.cpp` (what the values mean, and their scale: 1 at code 128).
"""

from __future__ import annotations

import re
from io import BytesIO
from pathlib import Path
from tokenize import TokenError

import numpy as np

from crfnet_core.files import atomic_write, atomic_write_text, read_bytes
from crfnet_core.types import Float64Array

from ..errors import LutError
from ..luts.rgb_lut import AnyLut
from ..luts.text import MAX_FILE_SIZE, LutText
from .calibration import CODES, calibrated_response, codes_table
from .response_file import ResponseFile

_YAML = """%YAML:1.0
---
response: !!opencv-matrix
   rows: 256
   cols: 1
   dt: "3f"
   data: [ {} ]
"""

_XML = """<?xml version="1.0"?>
<opencv_storage>
<response type_id="opencv-matrix">
  <rows>256</rows>
  <cols>1</cols>
  <dt>"3f"</dt>
  <data>{}</data></response>
</opencv_storage>
"""

_SHAPE = re.compile(
    r"rows\W+(\d+)\W+(?:rows\W+)?cols\W+(\d+)\W+(?:cols\W+)?dt\W+(\d*)[fd]\W+(?:dt\W+)?data\W*?[\[>]([^\]<]*)"
)


def read_opencv(path: Path) -> ResponseFile:
    """Return the response in a .npy, .yml, .yaml or .xml file.

    Raises
    ------
    LutError
        If it is absent, holds something else than 256 codes of 1 or 3 channels, or does not increase.
    """
    table = _read_npy(path) if path.suffix.lower() == ".npy" else _read_storage(path)
    if table.size not in (CODES, 3 * CODES) or table.shape[0] != CODES:
        raise LutError(f"{path}: has shape {table.shape}; OpenCV's responses have (256, 1, 3)")
    channels = table.reshape(CODES, -1)[:, ::-1]  # B, G, R to R, G, B
    return calibrated_response(path, channels, "OpenCV response (channels B, G, R)")


def write_opencv(path: Path, lut: AnyLut, *, overwrite: bool = False) -> tuple[str, ...]:
    """Write an inverse response for cv2.createMergeDebevec and cv2.createMergeRobertson, as .npy, .yml, .yaml or .xml.

    Raises
    ------
    LutError
        If the file exists and may not be replaced, or cannot be written.
    """
    response = codes_table(lut)[:, ::-1].astype(np.float32)[:, None]  # (256, 1, 3): B, G, R
    if path.suffix.lower() == ".npy":
        with atomic_write(path, overwrite=overwrite, error=LutError) as temporary, temporary.open("wb") as file:
            np.save(file, response)
        return ()
    numbers = ", ".join(f"{value:.9g}" for value in response.ravel().tolist())
    text = _XML.format(numbers.replace(",", "")) if path.suffix.lower() == ".xml" else _YAML.format(numbers)
    atomic_write_text(path, text, overwrite=overwrite, error=LutError)
    return ()


def _read_npy(path: Path) -> Float64Array:
    """Return the array in a .npy file."""
    try:
        with np.errstate(invalid="ignore"):  # a NaN of another kind stays a NaN
            return np.asarray(
                np.load(BytesIO(read_bytes(path, most=MAX_FILE_SIZE)), allow_pickle=False), dtype=np.float64
            )
    except OSError as problem:
        raise LutError(f"{path}: cannot be read ({problem.strerror or problem}); check the name") from problem
    except (ValueError, TypeError, EOFError, MemoryError, SyntaxError, TokenError) as problem:
        raise LutError(f"{path}: is no .npy file of numbers; save OpenCV's response with numpy.save") from problem


def _read_storage(path: Path) -> Float64Array:
    """Return the first matrix that `cv2.FileStorage` wrote."""
    text = "\n".join(LutText.read(path).lines)
    match = _SHAPE.search(text)
    if match is None:
        raise LutError(f"{path}: holds no matrix as cv2.FileStorage writes it; save OpenCV's response with it")
    rows, cols, channels = int(match[1]), int(match[2]), int(match[3] or 1)
    try:
        numbers = [float(token.lower().replace(".nan", "nan")) for token in match[4].replace(",", " ").split()]
        return np.reshape(numbers, (rows, cols, channels))
    except ValueError as problem:
        raise LutError(
            f"{path}: holds {match[1]} x {match[2]} values that are no or too few numbers; save it again"
        ) from problem
