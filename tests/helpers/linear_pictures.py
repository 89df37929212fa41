"""Scene-linear pictures for tests: camera raw as a camera would write it, OpenEXR and Radiance HDR."""

import csv

import numpy as np
from PIL.TiffImagePlugin import ImageFileDirectory_v2

from tests.helpers.images import write_image

#: Linear Rec.709 to CIE XYZ (IEC 61966-2-1), and XYZ to the RGB of two cameras: in the order of magnitude of real ones.
XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
CAMERAS = {
    "one": np.array([[0.70, -0.10, -0.08], [-0.45, 1.22, 0.22], [-0.10, 0.20, 0.65]]),
    "two": np.array([[0.92, -0.30, -0.10], [-0.38, 1.18, 0.20], [-0.05, 0.15, 0.55]]),
}

BYTE, ASCII, SHORT, LONG, RATIONAL, SRATIONAL = 1, 2, 3, 4, 5, 10  # TIFF's field types

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


def write_dng(path, scene, *, camera="one", pattern="RGGB", light=(1, 1, 1)):
    """Write the Bayer mosaic that a camera takes of a scene-linear Rec.709 scene, (H, W, 3), as a 16-bit DNG 1.4.

    The scene stands under a light of this colour, for which the camera is balanced; a gray of 1 saturates its most
    sensitive channel.
    """
    to_camera = CAMERAS[camera] @ XYZ * light
    neutral = to_camera.sum(axis=1)
    black, white = 1024, 65000
    sensed = np.clip(scene @ (to_camera / neutral.max()).T, 0, 1)
    mosaic = np.zeros(scene.shape[:2], dtype="<u2")
    for index, name in enumerate(pattern):
        own = np.s_[index // 2 :: 2, index % 2 :: 2]
        mosaic[own] = np.rint(black + (white - black) * sensed[(*own, "RGB".index(name))])
    height, width = mosaic.shape
    fields = {
        254: (LONG, 0),
        256: (LONG, width),
        257: (LONG, height),
        258: (SHORT, 16),
        259: (SHORT, 1),
        262: (SHORT, 32803),  # color filter array
        271: (ASCII, "Formula"),
        272: (ASCII, camera),
        273: (LONG, 0),  # behind the directory
        274: (SHORT, 1),  # upright
        277: (SHORT, 1),
        278: (LONG, height),
        279: (LONG, mosaic.nbytes),
        33434: (RATIONAL, 1),  # exposure time in seconds
        33421: (SHORT, (2, 2)),
        33422: (BYTE, bytes("RGB".index(name) for name in pattern)),
        50706: (BYTE, bytes([1, 4, 0, 0])),
        50708: (ASCII, f"Formula {camera}"),
        50714: (SHORT, black),
        50717: (SHORT, white),
        50721: (SRATIONAL, tuple(CAMERAS[camera].ravel().tolist())),  # XYZ to camera
        50728: (RATIONAL, tuple((neutral / neutral.max()).tolist())),  # as shot
        50778: (SHORT, 21),  # D65
    }
    directory = ImageFileDirectory_v2()
    for tag, (kind, value) in fields.items():
        directory.tagtype[tag] = kind
        directory[tag] = value
    with path.open("wb") as file:
        directory.save(file)
        file.write(mosaic.tobytes())
    return path


def write_float(path, pixels, depth="float", names=""):
    """Write (H, W, C) samples as OpenEXR or Radiance HDR, by the suffix, and return the path."""
    return write_image(path, np.asarray(pixels, dtype=np.float32), depth=depth, names=names)


def manifest(folder):
    """Return the rows of a folder's manifest.csv."""
    with (folder / "manifest.csv").open(newline="") as file:
        return list(csv.DictReader(file))
