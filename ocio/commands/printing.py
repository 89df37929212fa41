"""What the subcommands print: lines, a JSON document, a progress bar."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from tqdm import tqdm

from crfnet_core.types import Progress
from ocio import report


def print_json(document: Mapping[str, Any]) -> None:
    """Print a JSON document."""
    sys.stdout.write(report.json_text(document))


def print_lines(lines: Iterable[str]) -> None:
    """Print lines."""
    sys.stdout.writelines(f"{line}\n" for line in lines)


@contextmanager
def progress_bar(unit: str) -> Iterator[Progress | None]:
    """Yield a callback that moves a bar on stderr, or None where stderr is no terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    with tqdm(unit=f" {unit}", leave=False, file=sys.stderr) as bar:

        def show(done: int, total: int) -> None:
            bar.total = total
            bar.update(done - bar.n)

        yield show
