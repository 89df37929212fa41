"""Write and read image files with OpenImageIO, which is imported at first use: in Blender its own has to come first."""

from pathlib import Path

import numpy as np

#: OpenImageIO's names of the types that are not numpy's.
SAMPLE_TYPES = {"float16": "half", "float32": "float", "float64": "double"}


def write_image(path, samples, *more, names=(), depth="", origin=(0, 0), display=None, **attributes):
    """Write samples (H, W, C) as they are, in the format that the suffix names, and return the path.

    `more` are further images of the file, `names` its channels, such as "RGB" or ("X", "Z"), `depth` OpenImageIO's name
    of their type, `origin` the first column and row of the data window, and `display` those of the display window with
    its width and height. In the name of an attribute two underscores mean a colon; a tuple is its type and its value.
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


def read_image(path, *, kind="float"):
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
