"""The library of measured cameras that comes with the product: ``python -m training.export.cameras DATA``.

It is made of the measured responses of DATA/real_bodies (`training.data.real.stacks`): measurements, no photographs. A
body has an entry for each setting, by the most certain stack.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from crfnet_core.library import Camera, CameraLibrary
from training.data.real.stacks import measured_camera, settings_of_bodies


def measured_cameras(data: Path) -> list[Camera]:
    """Return the cameras of DATA/real_bodies, sorted by name."""
    return [
        measured_camera(name, stacks)
        for settings in settings_of_bodies(data).values()
        for name, stacks in settings.items()
    ]


def main() -> None:
    """Write the library anew."""
    parser = argparse.ArgumentParser(description="Write the library of cameras.")
    parser.add_argument("data", type=Path, help="the data folder, with real_bodies")
    cameras = measured_cameras(parser.parse_args().data)
    library = CameraLibrary.shipped()
    for camera in library.cameras():
        library.remove(camera.name)
    for camera in cameras:
        print(library.save(camera).name, camera.basis)


if __name__ == "__main__":
    main()
