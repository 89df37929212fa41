"""Write and read image files with OpenImageIO, which is imported at first use: in Blender its own has to come first."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: OpenImageIO's names of the types that are not numpy's.
SAMPLE_TYPES = {"float16": "half", "float32": "float", "float64": "double"}


def write_image(
    path: Path,
    samples: NDArray[Any],
    *more: NDArray[Any],
    names: tuple[str, ...] | str = (),
    depth: str = "",
    origin: tuple[int, int] = (0, 0),
    display: tuple[int, int, int, int] | None = None,
    **attributes: Any,
) -> Path:
    """Write `samples` as they are, in the format that the suffix names, and return the path.

    Parameters
    ----------
    path : Path
        The file; an existing one is replaced.
    samples : ndarray, shape (H, W, C)
        Code values or floats.
    *more : ndarray, shape (H, W, C)
        Further images for the same file, where its format can hold several.
    names : tuple of str or str, optional
        Names of the channels, such as "RGB" or ("X", "Z"); by default R, G, B and A, or Y.
    depth : str, optional
        OpenImageIO's name of the type in the file, such as "half"; by default the samples' type.
    origin : tuple of int
        Column and row at which the data window begins.
    display : tuple of int, optional
        The display window: its first column and row, its width and its height; by default the data window.
    **attributes
        What stands in the header. Two underscores in a name mean a colon, as in ``oiio__BitsPerSample=10``; a tuple is
        OpenImageIO's type and the value.
    """
    import OpenImageIO as oiio

    height, width, channels = samples.shape
    spec = oiio.ImageSpec(width, height, channels, depth or SAMPLE_TYPES.get(samples.dtype.name, samples.dtype.name))
    spec.x, spec.y = origin
    spec.full_x, spec.full_y, spec.full_width, spec.full_height = display or (*origin, width, height)
    if names:
        spec.channelnames = tuple(names)
    for name, value in attributes.items():
        words = value if isinstance(value, tuple) else (value,)
        spec.attribute(name.replace("__", ":"), *words)
    output = oiio.ImageOutput.create(str(path))
    assert output is not None, oiio.geterror()
    assert output.open(str(path), (spec,) * (1 + len(more))), output.geterror()
    assert output.write_image(np.ascontiguousarray(samples)), output.geterror()
    for image in more:
        assert output.open(str(path), spec, "AppendSubimage"), output.geterror()
        assert output.write_image(np.ascontiguousarray(image)), output.geterror()
    output.close()
    return path


def read_image(path: Path, *, kind: str = "float") -> NDArray[Any]:
    """Return the samples of an image, shape (H, W, C), as OpenImageIO converts them to `kind`, such as "uint8"."""
    import OpenImageIO as oiio

    image = oiio.ImageBuf(str(path))
    samples = image.get_pixels(kind)
    assert not image.has_error, image.geterror()
    return np.asarray(samples)


def make_photograph(path, width=6000, height=4000, *, seed=0):
    """Write the bundled photograph, mirrored and tiled to a size, with noise of its own everywhere."""
    pixels = np.rint(read_image(Path(__file__).parents[1] / "data" / "plate.jpg") * 255)
    pair = np.concatenate([pixels, pixels[:, ::-1]], axis=1)
    tile = np.concatenate([pair, pair[::-1]], axis=0)
    large = np.tile(tile, (-(-height // tile.shape[0]), -(-width // tile.shape[1]), 1))[:height, :width]
    noise = np.random.default_rng(seed).normal(0, 1.5, large.shape)
    write_image(path, np.clip(np.rint(large + noise), 0, 255).astype(np.uint8), Compression="jpeg:92")
