"""EXR files as OpenEXR, the reference library, reads them: the judge of every EXR that the project writes."""

import numpy as np
import pytest

OpenEXR = pytest.importorskip("OpenEXR", reason="comes with the test extra")


def read_reference(path):
    """Return the header (a dict) and the pixels, shape (H, W, C), of a file that OpenEXR calls complete.

    A file with an unwritten chunk has a gap in its chunk table, which `isComplete` sees.
    """
    file = OpenEXR.InputFile(str(path))
    try:
        assert file.isComplete(), f"{path}: the chunk table has gaps"
    finally:
        file.close()
    with OpenEXR.File(str(path), separate_channels=True) as image:
        channels = image.channels()
        names = [name for name in "RGBA" if name in channels]
        assert sorted(channels) == sorted(names)
        return dict(image.header()), np.stack([channels[name].pixels for name in names], axis=-1)
