"""What `crfnet estimate` costs beside oiiotool, and a curve beside its LUT, on large pictures: `make bench`."""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing import Process
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

PLATE = Path(__file__).parent / "data" / "plate.jpg"
WIDTH, HEIGHT = 6000, 4000
RUNS = 3

#: The budget: wall time as a multiple of oiiotool's, memory in GB.
MOST_TIMES, MOST_GB = 2.5, 1.5

#: The same for a curve: processor time as a multiple of its LUT's, on as many pixels of float32.
MOST_LUT_TIMES, ARRAY = 1.1, (3000, 4000, 3)


@dataclass(frozen=True)
class Cost:
    """Wall time in seconds and peak resident memory in GB of a process."""

    seconds: float
    gigabytes: float


def make_photograph(path: Path, width: int = WIDTH, height: int = HEIGHT) -> None:
    """Write the bundled photograph, mirrored and tiled to a size, with noise of its own everywhere."""
    pixels = np.asarray(oiio.ImageBuf(str(PLATE)).get_pixels(oiio.UINT8))
    pair = np.concatenate([pixels, pixels[:, ::-1]], axis=1)
    tile = np.concatenate([pair, pair[::-1]], axis=0)
    rows, columns = -(-height // tile.shape[0]), -(-width // tile.shape[1])
    large = np.tile(tile, (rows, columns, 1))[:height, :width]
    noise = np.random.default_rng(0).normal(0, 1.5, large.shape)
    codes = np.clip(np.rint(large + noise), 0, 255).astype(np.uint8)
    spec = oiio.ImageSpec(width, height, 3, oiio.UINT8)
    spec["Compression"] = "jpeg:92"
    image = oiio.ImageBuf(spec)
    image.set_pixels(image.roi, codes)
    image.write(str(path))


def measure(command: list[str]) -> Cost:
    """Run a command and return its cost."""
    start = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - start
    if status:
        sys.exit(f"failed: {' '.join(command)}")
    scale = 1 if sys.platform == "darwin" else 1024
    return Cost(seconds, usage.ru_maxrss * scale / 1e9)


def best(command: list[str]) -> Cost:
    """Return the least cost of several runs: the rest is other people's noise."""
    costs = [measure(command) for _ in range(RUNS)]
    return Cost(min(cost.seconds for cost in costs), max(cost.gigabytes for cost in costs))


def print_curve() -> None:
    """Print the processor time of a response and of its inverse beside that of the LUT; runs take turns."""
    from crfnet_core.response import ResponseCurve  # not earlier: others import this file for its photograph
    from ocio.luts.lut1d import inverse_response_lut

    curve, pixels = ResponseCurve.gamma(), np.random.default_rng(0).random(ARRAY, dtype=np.float32)
    calls: dict[str, Callable[..., object]] = {
        "Lut1D.apply": inverse_response_lut(curve).apply,
        "inverse": curve.inverse,
        "forward": curve.forward,
    }
    seconds = dict.fromkeys(calls, np.inf)
    for name in [*calls] * RUNS:
        start = time.process_time()
        calls[name](pixels)
        seconds[name] = min(seconds[name], time.process_time() - start)
    print(f"\n{ARRAY[0] * ARRAY[1] / 1e6:.0f} megapixels of float32, best of {RUNS} runs\n")
    for name, cost in seconds.items():
        print(f"{name:<28}{cost:>9.2f}{cost / seconds['Lut1D.apply']:>8.2f}")
    print(f"{'at most':<28}{'':>9}{MOST_LUT_TIMES:>8.2f}")


def main() -> None:
    """Print the tables."""
    programs = Path(sys.executable).parent
    with tempfile.TemporaryDirectory() as folder:
        photo = Path(folder, "photo.jpg")
        making = Process(target=make_photograph, args=(photo,))  # a child inherits its parent's peak memory
        making.start()
        making.join()
        conversion = best([str(programs / "oiiotool"), str(photo), "-o", f"{folder}/converted.exr"])
        out = ["--out", f"{folder}/out", "--overwrite"]
        estimate = best([str(programs / "crfnet"), "estimate", str(photo), *out, *sys.argv[1:]])
    print(f"\n{WIDTH * HEIGHT / 1e6:.0f} megapixels, JPEG to half-float EXR, best of {RUNS} runs\n")
    print(f"{'':<28}{'seconds':>9}{'times':>8}{'peak GB':>10}")
    for name, cost in (("oiiotool in.jpg -o out.exr", conversion), ("crfnet estimate in.jpg", estimate)):
        print(f"{name:<28}{cost.seconds:>9.2f}{cost.seconds / conversion.seconds:>8.2f}{cost.gigabytes:>10.2f}")
    print(f"{'at most':<28}{'':>9}{MOST_TIMES:>8.2f}{MOST_GB:>10.2f}")
    print_curve()


if __name__ == "__main__":
    main()
