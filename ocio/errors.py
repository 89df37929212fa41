"""The errors of LUTs, configs and plates: codes and facts; `messages` has their sentences."""

from collections.abc import Mapping
from pathlib import Path

from crfnet_core.errors import CRFNetError
from crfnet_core.messages import SENTENCES as CORE_SENTENCES

from .messages import SENTENCES


class OutputError(CRFNetError):
    """Base of the errors of this package, which writers in `crfnet_core` raise, too."""

    sentences: Mapping[str, str] = {**CORE_SENTENCES, **SENTENCES}


class LutError(OutputError):
    """A lookup table that is malformed or cannot be written."""


class ConfigError(OutputError):
    """An OpenColorIO config that does not load, validate or convert as it should."""


class PlateError(OutputError):
    """A plate or frame sequence that cannot be found, read or written."""


def error_of_file(problem: BaseException, path: Path) -> CRFNetError:
    """Return the error of one file of many, with its name, whatever its reader has raised; an interruption goes on."""
    if isinstance(problem, KeyboardInterrupt):
        raise problem
    if isinstance(problem, CRFNetError):
        return problem
    if isinstance(problem, MemoryError):
        return PlateError("no_memory", path=path)
    try:
        reason = str(problem)
    except Exception:  # noqa: BLE001 - even its text may fail
        reason = "no text"
    return PlateError("reader_failed", path=path, kind=type(problem).__name__, reason=reason)
