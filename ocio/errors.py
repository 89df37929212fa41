"""The errors of LUTs, configs and plates: codes and facts; `messages` has their sentences."""

from collections.abc import Mapping

from crfnet_core.errors import CRFNetError
from crfnet_core.messages import SENTENCES as CORE_SENTENCES

from .messages import SENTENCES

#: The sentences of both packages: writers in `crfnet_core` raise these errors, too.
_SENTENCES: Mapping[str, str] = {**CORE_SENTENCES, **SENTENCES}


class OutputError(CRFNetError):
    """Base of the errors of this package."""

    sentences = _SENTENCES


class LutError(OutputError):
    """A lookup table that is malformed or cannot be written."""


class ConfigError(OutputError):
    """An OpenColorIO config that does not load, validate or convert as it should."""


class PlateError(OutputError):
    """A plate or frame sequence that cannot be found, read or written."""
