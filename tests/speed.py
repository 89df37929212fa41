"""What crfnet costs: ``python -m tests.speed`` prints wall time, processor time and peak memory of each command.

Medians of five runs, each a process of its own, after one that is not counted. It needs POSIX. The last two rows
compare an estimate of 24 megapixels with a conversion by oiiotool.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

import OpenImageIO

from tests.helpers.images import make_photograph

ROOT = Path(__file__).parents[1]
OIIOTOOL = Path(OpenImageIO.__file__).parent / "bin" / "oiiotool"
RUNS = 5


def main():
    """Print one line a command."""
    python = [sys.executable, "-m", "crfnet"]
    with tempfile.TemporaryDirectory() as folder:
        large = Path(folder, "large.jpg")
        make_photograph(large)
        plate, out = ROOT / "tests/data/plate.jpg", ["--out", f"{folder}/out", "--overwrite"]
        commands = {
            "import crfnet": [sys.executable, "-c", "import crfnet"],
            "crfnet --help": [*python, "--help"],
            "crfnet estimate, the demo": [*python, "estimate", str(plate), *out],
            "crfnet estimate, 24 megapixels": [*python, "estimate", str(large), *out],
            "oiiotool in.jpg -o out.exr, the same": [str(OIIOTOOL), str(large), "-o", f"{folder}/out.exr"],
        }
        for name, command in commands.items():
            wall, processor, memory = map(median, zip(*[cost(command) for _ in range(RUNS + 1)][1:], strict=True))
            print(f"{name:38} {wall:6.2f} s  {processor:6.2f} s CPU  {memory:6.0f} MB")


def cost(command):
    """Return wall time and processor time in seconds, and peak memory in MB, of a command."""
    begin = time.perf_counter()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    assert status == 0, command
    return time.perf_counter() - begin, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


if __name__ == "__main__":
    main()
