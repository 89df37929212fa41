"""What a change of a config has written, undone where the change fails."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

from crfnet_core.errors import CRFNetError
from crfnet_core.files import atomic_write


@contextmanager
def as_before_on_failure(paths: Iterable[Path]) -> Iterator[None]:
    """Run a block; if it fails or is cancelled, put back those of `paths` that it has changed, and remove new ones."""
    earlier = {path: _State.of(path) for path in paths}
    try:
        yield
    except BaseException:
        for path, state in earlier.items():
            if _State.of(path) != state:
                with suppress(OSError, CRFNetError):
                    state.put_back(path)
        raise


class _State(NamedTuple):
    """What a path is: the target of a link, the content of a file and its permissions; nothing of what is no file."""

    is_there: bool
    link: str | None
    content: bytes | None
    mode: int

    @classmethod
    def of(cls, path: Path) -> _State:
        """Return what a path is; a file that cannot be read has no content."""
        content, mode = None, 0
        with suppress(OSError):
            content, mode = path.read_bytes(), path.stat().st_mode
        return cls(os.path.lexists(path), str(path.readlink()) if path.is_symlink() else None, content, mode)

    def put_back(self, path: Path) -> None:
        """Make a path be so again, as far as that is known."""
        if not self.is_there or self.link is not None:
            path.unlink(missing_ok=True)
        if self.link is not None:
            path.symlink_to(self.link)
        elif self.content is not None:
            with atomic_write(path, overwrite=True) as temporary:
                temporary.write_bytes(self.content)
                temporary.chmod(self.mode)
