"""Five of Blender's studio lights (CC0), to measure with where there is no other data; no training scene is among them.

    python -m training.data.studio_lights --studio-lights <bpy>/4.5/datafiles/studiolights/world --out tests/data/lights

copies them as they are stored. Sunrise, sunset and night are left out, because the training data holds these panoramas.
"""

from __future__ import annotations

import argparse
import hashlib
from dataclasses import dataclass
from pathlib import Path

from crfnet_core.errors import CRFNetError
from crfnet_core.files import atomic_write, atomic_write_text
from training.data.scenes import BAND, Scene, read_scene

#: Where the repository keeps them.
LIGHTS_FOLDER = Path(__file__).parents[2] / "tests" / "data" / "lights"


@dataclass(frozen=True)
class StudioLight:
    """A file of Blender, the name of the panorama at Poly Haven, and the SHA-256 of the file."""

    file: str
    source: str
    sha256: str


LIGHTS = (
    StudioLight("city.exr", "portland_landing_pad", "9e42abcd2fa3231e5c2485ca6dd64800534d157b7194ab7fe9cc3bf5a56d0256"),
    StudioLight("courtyard.exr", "courtyard", "6690b47725965531559380121e6878373eb599655e35fefd109a4bd0911366f3"),
    StudioLight("forest.exr", "ninomaru_teien", "bdf2298244affa0f85509380fd130ac6d4dfaa3c856df065998f7f4c1a93dc0d"),
    StudioLight("interior.exr", "hotel_room", "e945ff5c1ddd7a3aaf05e9fb5c3bc9cb93c5518414febd44ed2c394e013f0cbd"),
    StudioLight(
        "studio.exr", "studio_small_01, probably", "c36c7fd390b2cdf8693360cf3662cb1d710c95fa799d9f822f42997167839b56"
    ),
)

README = """# Five studio lights

Panoramas by Greg Zaal, Poly Haven, as they come with Blender 4.5 (`datafiles/studiolights/world`): 1024 x 512, linear,
DWAB-compressed OpenEXR. Licence: CC0 (public domain), says Blender's `license.txt` beside them.

| file | original | sha256 |
| --- | --- | --- |
{rows}

`python -m training.evaluation --quick` takes photographs of their middle rows ({low:.0%} to {high:.0%} of the height).
Blender's sunrise, sunset and night are left out, because training sees these scenes.

To write the folder again, byte for byte:

    python -m training.data.studio_lights --studio-lights <bpy>/4.5/datafiles/studiolights/world --out tests/data/lights
"""


def read_light(path: Path) -> Scene:
    """Return the middle rows of a studio light, scaled so that the geometric mean of their luminance is 1.

    Raise CRFNetError if the file is absent.
    """
    if not path.is_file():
        raise CRFNetError(f"{path}: is absent; write the lights with python -m training.data.studio_lights")
    pixels = read_scene(path, is_panorama=True).pixels
    low, high = (round(fraction * len(pixels)) for fraction in BAND)
    return Scene.scaled(path.stem, pixels[low:high], is_panorama=True)


def copy_lights(source: Path, target: Path) -> None:
    """Copy the five files and write their README.md.

    Raise CRFNetError if one is absent, or is not the file of Blender 4.5.
    """
    for light in LIGHTS:
        path = source / light.file
        if not path.is_file():
            raise CRFNetError(f"{path}: is absent; give the folder datafiles/studiolights/world of Blender 4.5")
        content = path.read_bytes()
        if hashlib.sha256(content).hexdigest() != light.sha256:
            raise CRFNetError(f"{path}: is not the file of Blender 4.5; take it from bpy 4.5")
        with atomic_write(target / light.file, overwrite=True) as temporary:
            temporary.write_bytes(content)
    rows = "\n".join(f"| `{light.file}` | {light.source} | `{light.sha256}` |" for light in LIGHTS)
    text = README.format(rows=rows, low=BAND[0], high=BAND[1])
    atomic_write_text(target / "README.md", text, overwrite=True)


def main() -> None:
    """Copy the lights."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--studio-lights", type=Path, required=True, help="Blender's folder of world lights")
    parser.add_argument("--out", type=Path, default=LIGHTS_FOLDER, help="folder to write to (tests/data/lights)")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    try:
        copy_lights(options.studio_lights, options.out)
    except CRFNetError as problem:
        raise SystemExit(str(problem)) from None
    print(f"wrote {len(LIGHTS)} lights to {options.out}")


if __name__ == "__main__":
    main()
