"""The library of measured cameras that comes with the product: ``python -m training.export.cameras DATA``.

It is made of the measured responses of DATA/real_bodies (`training.data.real.stacks`): measurements, no photographs. A
body has an entry for each setting, by the most certain stack. One more is measured here, as `crfnet calibrate` does, on
the raw files in DATA/raw_pairs.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from crfnet_core.calibration import calibrate_pairs
from crfnet_core.library import Camera, CameraLibrary
from training.data.real.stacks import measured_camera, raw_camera, settings_of_bodies

#: The folder of raw files with their JPEGs, all of one body.
RAW_PAIRS = "raw_pairs"


def measured_cameras(data: Path) -> list[Camera]:
    """Return the cameras of DATA/real_bodies, sorted by name, and the one of DATA/raw_pairs if it is there."""
    cameras = [
        measured_camera(name, stacks)
        for settings in settings_of_bodies(data).values()
        for name, stacks in settings.items()
    ]
    folder = data / RAW_PAIRS
    return [*cameras, raw_camera(calibrate_pairs([folder]))] if folder.is_dir() else cameras


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
