"""Files that belong together: either all are written, or the folder is as it was."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

from crfnet_core.files import check_target

from ..errors import PlateError
from ..output_files import check_folder, output_folder
from ..staging import staged_files


@contextmanager
def all_or_none(targets: Sequence[Path], *, overwrite: bool = False) -> Iterator[tuple[Path, ...]]:
    """Yield the paths that a block writes files to; if it succeeds, they take their names together.

    If it fails or is cancelled, the folder is as it was, or gone if it was made for the files.

    Parameters
    ----------
    targets : sequence of Path
        The files, all in one folder.
    overwrite : bool
        Whether existing files may be replaced.

    Raises
    ------
    CRFNetError
        If a file exists and may not be replaced, or the folder cannot be made or written to.
    """
    folder = targets[0].parent
    check_folder(folder)
    with ExitStack() as stack:
        try:
            stack.enter_context(output_folder(folder))
            for target in targets:
                check_target(target, overwrite=overwrite)
            temporary = stack.enter_context(staged_files(folder, overwrite=overwrite))
        except OSError as problem:  # such as on Windows, which does not say before what is not allowed
            reason = problem.strerror or problem
            raise PlateError(f"{folder}: cannot be written to ({reason}); choose another folder") from problem
        yield tuple(temporary / target.name for target in targets)
