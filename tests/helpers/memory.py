"""The memory that this process takes, and that reading takes in a process of its own."""

import sys
from pathlib import Path

from tests.helpers.processes import ran

READ = """
import sys
from pathlib import Path
from crfnet_core.errors import PhotoError
from crfnet_core.photograph.image_io import read_photo
def peak():  # not that of getrusage, which begins with the peak of the process that started this one
    return int(Path("/proc/self/status").read_text().split("VmHWM:")[1].split()[0])
before, is_read = peak(), []
for name in sys.argv[1:]:
    try:
        is_read.append(bool(read_photo(name)))
    except PhotoError:
        is_read.append(False)
print(peak() - before, any(is_read))
"""


def memory_of_reading(*paths):
    """Return the kB beyond what the imports take, as Linux reports them, and whether any of the files was read."""
    done = ran(sys.executable, "-c", READ, *map(str, paths), cwd=Path(__file__).parents[2], timeout=30)
    size, is_read = done.stdout.split()
    return int(size), is_read == "True"


def peak_of_now():
    """Return the most bytes of memory that this process has had since the last call; 0 where the system does not say.

    `getrusage` would not do: it has the peak of the whole run, below which no case is seen.
    """
    try:
        status = Path("/proc/self/status").read_text()
        Path("/proc/self/clear_refs").write_text("5")
    except OSError:
        return 0
    return int(status.split("VmHWM:")[1].split()[0]) * 1024
