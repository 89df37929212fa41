"""The errors of LUTs, configs and plates: codes and facts; `messages` has their sentences."""

from crfnet_core.errors import CRFNetError

from .messages import SENTENCES


class OutputError(CRFNetError):
    """Base of the errors of this package."""

    sentences = SENTENCES


class LutError(OutputError):
    """A lookup table that is malformed or cannot be written."""


class ConfigError(OutputError):
    """An OpenColorIO config that does not load, validate or convert as it should."""


class PlateError(OutputError):
    """A plate or frame sequence that cannot be found, read or written."""
