import shutil
from functools import partial

import numpy as np
import pytest

from crfnet.plates.frame_files import read_frame
from crfnet_core.colorimetry import DISPLAY_P3
from crfnet_core.photograph.image_io import read_photo
from crfnet_core.photograph.metadata import file_origin
from crfnet_core.posterior.factors import family_factors
from tests.helpers.color_profiles import matrix_profile, write_tagged
from tests.helpers.images import write_image
from tests.helpers.mutations import mutated

#: Name of a seed, how many bits its samples have, and attributes with which it is written.
SEEDS = {
    **dict.fromkeys(("plain.jpg", "gray.jpg", "8.dpx", "8.jp2", "8.jxl", "8.bmp"), (8, {})),
    "progressive.jpg": (8, {"jpeg__progressive": 1}),
    "exif.jpg": (8, {"Make": "MAKER", "Model": "B", "Exif__ExposureTime": 0.01, "Orientation": 6, "Software": "x"}),
    "8.png": (8, {"Comment": "text"}),
    "16.png": (16, {}),
    "8.tif": (8, {"compression": "none"}),
    "lzw.tif": (8, {"compression": "lzw"}),
    "zip.tif": (16, {"compression": "zip"}),
    "tiled.tif": (16, {"tile_width": 16, "tile_height": 16}),
    "10.dpx": (16, {"oiio__BitsPerSample": 10}),
    "lossy.webp": (8, {"compression": "webp:80"}),
    "lossless.webp": (8, {"compression": "lossless"}),
    "half.exr": (0, {"compression": "zip", "owner": "a"}),
    "piz.exr": (0, {"compression": "piz"}),
}


@pytest.fixture(scope="module")
def seeds(tmp_path_factory, root):
    """The content of a small file of each kind, by name; kinds that this OpenImageIO cannot write are left out."""
    folder = tmp_path_factory.mktemp("seeds")
    rows, columns = np.mgrid[:48, :64] / 64
    smooth = np.stack([rows, columns, rows * columns], axis=2) + np.random.default_rng(0).random((48, 64, 3)) / 16
    for name, (bits, attributes) in SEEDS.items():
        channels = smooth[..., :1] if name.startswith("gray") else smooth
        samples = (channels * (2**bits - 1) / 2).astype(f"uint{bits}") if bits else channels.astype(np.float16)
        try:
            write_image(folder / name, samples, **attributes)
        except AssertionError:
            (folder / name).unlink(missing_ok=True)
    codes, icc = (smooth * 127).astype(np.uint8), matrix_profile(DISPLAY_P3)
    for name in ("icc.jpg", "icc.png", "icc.tif"):
        write_tagged(folder / name, codes, icc, ImageDescription="x" * 20)
    half = smooth.astype(np.float16)
    write_image(folder / "parts.exr", half, half)
    write_image(folder / "layers.exr", np.dstack([half, half]), names=("R", "G", "B", "diffuse.R", "diffuse.G", "Z"))
    ultra = (smooth * 4).astype(np.float16)
    write_image(folder / "ultra_hdr.jpg", ultra, jpeg__ultrahdr=1, oiio__ColorSpace="lin_rec709_scene")
    for path in (root / "tests" / "data" / "heif").glob("*.[ah][ve]i[fc]"):
        shutil.copy(path, folder)
    content = {path.name: path.read_bytes() for path in sorted(folder.iterdir())}
    return content | {"latin1.jpg": content["exif.jpg"].replace(b"MAKER", b"M\xe4\xff\x80R")}


def read_origin(path):
    """Read a photograph and draw the conclusions from its metadata."""
    origin = file_origin(read_photo(path).metadata)
    family_factors(origin)
    " ".join(origin.words).encode()


@pytest.mark.parametrize("read", [read_origin, partial(read_frame, is_encoded=True)], ids=["photograph", "plate"])
def test_damaged_images_are_read_or_refused_in_one_line(fuzz, refused, seeds, tmp_path, read):
    names = list(seeds)
    assert len(names) > 20

    def case(generator):
        name = names[generator.integers(len(names))]
        path = tmp_path / name
        path.write_bytes(mutated(seeds[name], generator))
        refused(read, path)

    fuzz(case)
