"""The bank of responses that the posterior weighs: ``python -m training.data.response_bank --data DIR``."""

import argparse
from io import BytesIO
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np

from crfnet_core.files import atomic_write
from crfnet_core.posterior import BANK_FILE, Family, ResponseBank
from crfnet_core.posterior.responses import STORED_STEPS
from crfnet_core.types import Float64Array
from training.data.curves import CurveSource, read_dorf
from training.data.families import draw_responses
from training.data.in_camera import InCameraResponses
from training.data.real_photographs import measured_bodies
from training.data.splits import SPLITS

SEED = 2017

#: Responses of each family. Of film the curves of DoRF themselves come first.
COUNTS = {
    Family.PHONE: 250,
    Family.COMPACT: 250,
    Family.CAMERA: 300,
    Family.EDITED: 400,
    Family.FILM: 600,
    Family.LINEAR: 40,
    Family.LOG: 60,
    Family.DEVELOPED: 200,
}


def make_bank(data: Path, *, without: str | None = None, without_held_out: bool = False) -> ResponseBank:
    """Return the bank of the folder `data`, which holds dorf, real and real_bodies.

    `without` leaves out the bodies of a fold, as `measured_bodies` does, and `without_held_out` the curves of DoRF that
    P2 holds out.
    """
    in_camera = InCameraResponses.from_bodies(measured_bodies(data, without=without))
    dorf = read_dorf(data)
    if without_held_out:
        dorf = np.delete(dorf, SPLITS["held_out_curves"], axis=0)
    film = CurveSource(dorf, (), camera_fraction=0, plain_fraction=0).draw
    rows: list[Float64Array] = []
    for number, (family, count) in enumerate(COUNTS.items()):
        known, rng = dorf if family is Family.FILM else dorf[:0], np.random.default_rng([SEED, number])
        rows += [known, draw_responses(family, count - len(known), rng, in_camera=in_camera.draw, film=film)]
    members = [family for family, count in COUNTS.items() for _ in range(count)]
    return ResponseBank(np.concatenate(rows).astype(np.float32), tuple(members))


def write_bank(bank: ResponseBank, path: Path) -> None:
    """Write a bank as `ResponseBank.load` reads it: brightness in 65536 steps, as second differences along irradiance.

    These are small and often equal, so that the file is 40 % smaller than with first differences; they wrap at 65536.
    """
    rounded = np.rint(bank.brightness.astype(np.float64) * STORED_STEPS).astype(np.uint16)
    second_differences = np.diff(rounded, n=2, axis=1, prepend=np.zeros((len(rounded), 2), np.uint16))
    numbers = np.array([list(Family).index(family) for family in bank.families], np.uint8)
    arrays = {"second_differences": second_differences, "families": numbers}
    with atomic_write(path, overwrite=True) as temporary, ZipFile(temporary, "w") as bank_file:
        for name, array in arrays.items():
            content = BytesIO()
            np.save(content, array)
            bank_file.writestr(ZipInfo(f"{name}.npy"), content.getvalue(), ZIP_DEFLATED, 9)  # an entry without a date


def main() -> None:
    """Write the packaged bank."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf, real and real_bodies")
    bank = make_bank(parser.parse_args().data)
    write_bank(bank, BANK_FILE)
    print(f"wrote {BANK_FILE}: {len(bank.families)} responses, {BANK_FILE.stat().st_size} bytes")


if __name__ == "__main__":
    main()
