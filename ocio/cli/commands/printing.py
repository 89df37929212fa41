"""The output of the subcommands: lines, a JSON document, a progress bar."""

import atexit
import errno
import os
import shlex
import shutil
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from tqdm import tqdm

from crfnet_core.files import json_text
from crfnet_core.staging import is_own_folder
from crfnet_core.types import Progress

from ..streams import shown

#: Seconds between two lines of progress without a terminal.
LINE_SECONDS = 60


def prepare_matplotlib() -> bool:
    """Make matplotlib draw without a window, and return whether it is there; if not, say on stderr what to do."""
    os.environ["MPLBACKEND"] = "agg"  # a sheet needs no window, and matplotlib fails at a backend that it does not know
    reason = "matplotlib is absent: pip install 'crfnet[plot]'"
    if find_spec("matplotlib") is not None:
        try:
            if "MPLCONFIGDIR" not in os.environ:
                os.environ["MPLCONFIGDIR"] = _font_folder()
            return True
        except OSError:
            reason = "no folder takes temporary files: set TMPDIR to one"
    print(f"crfnet: no sheet is drawn, {reason}, or add --no-sheet", file=sys.stderr)  # noqa: T201
    return False


def _font_folder() -> str:
    """Return a folder for the list of fonts, not in the user's home; it lasts, because listing the fonts takes long."""
    user = os.getuid() if hasattr(os, "getuid") else 0
    folder = Path(tempfile.gettempdir(), f"crfnet-matplotlib-{user}")
    with suppress(OSError):
        folder.mkdir(mode=0o700, exist_ok=True)
        if is_own_folder(folder) and (os.name == "nt" or not folder.stat().st_mode & 0o077):
            return str(folder)
    folder = Path(tempfile.mkdtemp(prefix="crfnet-matplotlib-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return str(folder)


def print_result(document: Mapping[str, Any], lines: Iterable[str], *, as_json: bool) -> None:
    """Print a JSON document, or the same in lines; raise OSError for a document where the output is closed."""
    if as_json:
        if sys.__stdout__ is None:
            raise OSError(errno.EBADF, os.strerror(errno.EBADF))
        sys.stdout.write(json_text(document, ensure_ascii=True))  # whatever encoding the output has
    else:
        sys.stdout.writelines(f"{shown(line)}\n" for line in lines)


def lost_document(names: Sequence[str]) -> dict[str, Any]:
    """Return the names of plates that a replaced config has no more, for JSON; empty without any."""
    return {"dropped": list(names)} if names else {}


def lost_lines(config: Path, names: Sequence[str]) -> list[str]:
    """Return a warning of these plates, with the command that brings them back."""
    if not names:
        return []
    which = f'"{names[0]}"' + f" and {len(names) - 1} more" * bool(names[1:])
    remedy = f"crfnet config add --base {shlex.quote(str(config))} --out FOLDER ESTIMATE, the JSON of the other"
    return [
        f"Warning: {config.name} was replaced and no longer has {which}; a config with both is written by {remedy}."
    ]


@contextmanager
def progress_bar(unit: str) -> Iterator[Progress]:
    """Yield a callback that moves a bar on stderr; where stderr is not a terminal, it prints one line a minute."""
    if not sys.stderr.isatty():
        yield _minute_lines(unit)
        return
    with tqdm(unit=f" {unit}", leave=False, file=sys.stderr) as bar:

        def show(done: int, total: int) -> None:
            bar.total = total
            bar.update(done - bar.n)

        yield show


def _minute_lines(unit: str) -> Progress:
    """Return a callback that prints how far a run is, for the log of a render farm; a short run prints nothing."""
    start = time.monotonic()
    due, before = start + LINE_SECONDS, -1

    def show(done: int, total: int) -> None:
        nonlocal due, before
        before = done if before < 0 else before  # done in an earlier run, which says nothing of how long the rest takes
        if (now := time.monotonic()) >= due:
            seconds = (now - start) * (total - done) / (done - before) if done > before else 0.0
            rest = f", {tqdm.format_interval(seconds)} left" if seconds else ""
            print(f"crfnet: {done} of {total} {unit}{rest}", file=sys.stderr, flush=True)  # noqa: T201
            due = now + LINE_SECONDS

    return show
