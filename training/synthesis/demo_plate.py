"""Make the bundled photograph, tests/data/plate.jpg, whose true response is known.

    python -m training.synthesis.demo_plate <site-packages>/bpy/4.5/datafiles/studiolights/world/forest.exr

The scene is one of Blender's studio lights (CC0, Greg Zaal's "Ninomaru Teien" at Poly Haven). It is cropped but never
resampled, because averaging would mix irradiance before the camera. The camera is simulated: exposure, shot and read
noise, a response of the in-camera kind, 8 bits, JPEG. The same source gives the same bytes. This module does not use
`training.synthesis.camera`, so the plate stays the same when training changes.
"""

import argparse
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from crfnet_core.errors import PhotoError
from crfnet_core.response.curve import UNIFORM, ResponseCurve
from crfnet_core.response.transfer_functions import srgb_encode
from crfnet_core.types import Float64Array, Uint8Array

#: Rows and columns of the panorama (1024 x 512) that make the photograph, 672 x 378.
ROWS, COLUMNS = range(84, 462), range(300, 972)
#: Percentage of the values that lie below the clipping of the sensor.
EXPOSED = 95.0
#: The variance of the noise at irradiance E is SHOT * E + READ**2, where 1 clips: about ISO 400 of a full-frame camera.
SHOT, READ = 5e-5, 4e-4
SEED = 2017
JPEG_QUALITY = 95

#: Highlight roll-off (1 is none) and strength of the S-curve (0 is none, 1 is smoothstep). So this response is about as
#: far from the mean of measured cameras as half of them are: 0.09 stop and an E_est of 1.4 (they 0.09 and 1.1).
ROLL_OFF, CONTRAST = 1.5, 0.8


def camera_response(irradiance: Float64Array, roll_off: float = ROLL_OFF, contrast: float = CONTRAST) -> Float64Array:
    """Return brightness f(E) of a simulated camera, by default the plate's: roll-off, sRGB encoding, S-curve.

    Nobody measured this curve, but cameras have such curves. E is in [0, 1]; `roll_off` 1 leaves the roll-off out and
    `contrast` 0 the S-curve, which is smoothstep at 1.
    """
    rolled = roll_off * irradiance / (1 + (roll_off - 1) * irradiance)
    encoded = srgb_encode(rolled)
    return (1 - contrast) * encoded + contrast * encoded**2 * (3 - 2 * encoded)


def read_scene(studio_light: str | Path) -> Float64Array:
    """Return the linear scene, float64 (H, W, 3), any scale; PhotoError if the file cannot be read."""
    image = oiio.ImageBuf(str(studio_light))
    if image.has_error or not image.initialized:
        raise PhotoError(f"{studio_light}: cannot be read; give the forest.exr of Blender's studio lights")
    panorama: Float64Array = np.asarray(image.get_pixels(oiio.FLOAT), dtype=np.float64)
    return panorama[np.ix_(ROWS, COLUMNS, range(3))]


def photograph(scene: Float64Array) -> Uint8Array:
    """Return the photograph that the simulated camera takes of a linear scene, uint8 (H, W, 3)."""
    exposed = np.clip(scene / np.percentile(scene, EXPOSED), 0, 1)
    noise = np.random.default_rng(SEED).standard_normal(scene.shape) * np.sqrt(SHOT * exposed + READ**2)
    return np.rint(255 * camera_response(np.clip(exposed + noise, 0, 1))).astype(np.uint8)


def write_photograph(path: Path, pixels: Uint8Array) -> None:
    """Write the JPEG, without chroma subsampling and without metadata that names the software."""
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, oiio.UINT8)
    spec["Compression"] = f"jpeg:{JPEG_QUALITY}"
    spec["jpeg:subsampling"] = "4:4:4"
    image = oiio.ImageBuf(spec)
    image.set_pixels(image.roi, pixels)
    if not image.write(str(path)):
        raise PhotoError(f"{path}: {image.geterror()}")


def main() -> None:
    """Write plate.jpg and plate_response.csv, with a row of irradiance and brightness for each sample."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("studio_light", type=Path, help="forest.exr of Blender's studio lights")
    folder = Path("tests/data")
    write_photograph(folder / "plate.jpg", photograph(read_scene(parser.parse_args().studio_light)))
    samples = np.stack([UNIFORM, ResponseCurve.from_samples(camera_response(UNIFORM)).brightness], axis=1)
    header = "irradiance,brightness"
    np.savetxt(folder / "plate_response.csv", samples, fmt="%.9g", delimiter=",", header=header, comments="")


if __name__ == "__main__":
    main()
