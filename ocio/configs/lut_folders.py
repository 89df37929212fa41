"""The folders beside a config in which its LUTs lie, copied to where a config that is built on it goes."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import PyOpenColorIO as OCIO


@contextmanager
def copied_lut_folders(config: OCIO.Config, folder: Path, home: Path | None) -> Iterator[tuple[str, ...]]:
    """Copy a config's LUT folders from its home to a new folder; yield their names; undo it if the block fails.

    Search paths that cannot be copied point to where they are. `home` is None for a config that is in `folder` already.
    """
    copied: list[str] = []
    try:
        names = [] if home is None else [name for name in config.getSearchPaths() if name != "."]
        if names:
            config.clearSearchPaths()
        for name in names:
            is_copyable = Path(name).name == name and (home / name).is_dir() and not (folder / name).exists()
            config.addSearchPath(name if is_copyable else str(home / name))
            if is_copyable:
                copied.append(name)
                shutil.copytree(home / name, folder / name)
        yield tuple(copied)
    except BaseException:
        for name in copied:
            shutil.rmtree(folder / name, ignore_errors=True)
        raise
