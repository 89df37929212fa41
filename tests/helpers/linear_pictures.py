"""Scene-linear pictures for tests: camera raw as a camera would write it, OpenEXR and Radiance HDR."""

import csv
import struct

import numpy as np

from tests.helpers.images import write_image

#: Linear Rec.709 to CIE XYZ (IEC 61966-2-1), and XYZ to the RGB of two cameras: in the order of magnitude of real ones.
XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
CAMERAS = {
    "one": np.array([[0.70, -0.10, -0.08], [-0.45, 1.22, 0.22], [-0.10, 0.20, 0.65]]),
    "two": np.array([[0.92, -0.30, -0.10], [-0.38, 1.18, 0.20], [-0.05, 0.15, 0.55]]),
}

#: TIFF's field types: struct code and the size of one value.
BYTE, ASCII, SHORT, LONG, RATIONAL, SRATIONAL = (1, "B"), (2, "s"), (3, "H"), (4, "I"), (5, "I"), (10, "i")

SWATCH = 32  # sensor pixels along a side


def chart(values, rows=8, columns=10):
    """Return a scene (H, W, 3) of flat swatches, `values` (N, 3) repeated over rows x columns of them."""
    values = np.resize(np.asarray(values, dtype=np.float64), (rows * columns, 3)).reshape(rows, columns, 3)
    return values.repeat(SWATCH, axis=0).repeat(SWATCH, axis=1)


def ramp(top):
    """Return eighty gray swatches, brightest `top`, half a stop apart and then again from the top."""
    return np.repeat(top * 2.0 ** -(np.arange(16) / 2)[:, None], 3, axis=1)


def swatch_means(pixels, size):
    """Return the mean of the middle half of each swatch of `size` samples, shape (rows, columns, 3)."""
    rows, columns = (side // size for side in pixels.shape[:2])
    quarter = size // 4
    cells = pixels[: rows * size, : columns * size].reshape(rows, size, columns, size, 3)
    return cells[:, quarter:-quarter, :, quarter:-quarter].astype(np.float64).mean(axis=(1, 3))


def write_dng(path, scene, *, camera="one", pattern="RGGB", light=(1, 1, 1), black=1024, white=65000, orientation=1):
    """Write the Bayer mosaic that a camera takes of a scene-linear Rec.709 scene, (H, W, 3), as a 16-bit DNG 1.4.

    The scene stands under a light of this colour, for which the camera is balanced; a gray of 1 saturates its most
    sensitive channel.
    """
    to_camera = CAMERAS[camera] @ XYZ * light
    neutral = to_camera.sum(axis=1)
    sensed = np.clip(scene @ (to_camera / neutral.max()).T, 0, 1)
    mosaic = np.zeros(scene.shape[:2], dtype="<u2")
    for index, name in enumerate(pattern):
        own = np.s_[index // 2 :: 2, index % 2 :: 2]
        mosaic[own] = np.rint(black + (white - black) * sensed[(*own, "RGB".index(name))])
    height, width = mosaic.shape
    write_tiff(
        path,
        mosaic.tobytes(),
        {
            256: (LONG, [width]),
            257: (LONG, [height]),
            258: (SHORT, [16]),
            259: (SHORT, [1]),
            262: (SHORT, [32803]),  # colour filter array
            271: (ASCII, b"Formula\0"),
            272: (ASCII, camera.encode() + b"\0"),
            274: (SHORT, [orientation]),
            277: (SHORT, [1]),
            278: (LONG, [height]),
            33421: (SHORT, [2, 2]),
            33422: (BYTE, ["RGB".index(name) for name in pattern]),
            50706: (BYTE, [1, 4, 0, 0]),
            50708: (ASCII, b"Formula " + camera.encode() + b"\0"),
            50714: (SHORT, [black]),
            50717: (SHORT, [white]),
            50721: (SRATIONAL, fractions(CAMERAS[camera])),  # XYZ to camera
            50728: (RATIONAL, fractions(neutral / neutral.max())),  # as shot
            50778: (SHORT, [21]),  # D65
        },
    )
    return path


def write_tiff(path, strip, fields):
    """Write a little-endian TIFF file of one directory and one strip."""
    fields = {254: (LONG, [0]), **fields, 273: (LONG, [0]), 279: (LONG, [len(strip)])}
    offset = 8 + 2 + 12 * len(fields) + 4
    entries, values = b"", b""
    for tag, ((kind, code), numbers) in sorted(fields.items()):
        if tag == 273:
            numbers = [offset + sum((len(packed(*field)) + 1) // 2 * 2 for field in fields.values())]
        content = packed((kind, code), numbers)
        count = len(content) // {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 10: 8}[kind]
        value = content.ljust(4, b"\0") if len(content) <= 4 else struct.pack("<I", offset + len(values))
        entries += struct.pack("<HHI", tag, kind, count) + value
        values += content.ljust((len(content) + 1) // 2 * 2, b"\0")
    directory = struct.pack("<H", len(fields)) + entries + bytes(4)
    path.write_bytes(b"II*\0" + struct.pack("<I", 8) + directory + values + strip)


def fractions(numbers):
    """Return numerators and denominators, shape (N, 2)."""
    return np.stack([np.rint(np.ravel(numbers) * 10**6), np.full(np.size(numbers), 10**6)], axis=1)


def packed(kind, numbers):
    """Return the bytes of a TIFF field's values."""
    flat = [int(number) for number in np.ravel(numbers)] if kind != ASCII else []
    return numbers if kind == ASCII else struct.pack(f"<{len(flat)}{kind[1]}", *flat)


def write_float(path, pixels, depth="float", names=""):
    """Write (H, W, C) samples as OpenEXR or Radiance HDR, by the suffix, and return the path."""
    return write_image(path, np.asarray(pixels, dtype=np.float32), depth=depth, names=names)


def manifest(folder):
    """Return the rows of a folder's manifest.csv."""
    with (folder / "manifest.csv").open(newline="") as file:
        return list(csv.DictReader(file))
