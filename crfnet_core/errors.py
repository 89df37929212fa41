"""The errors that this project raises for a user's mistake; every message is one line that says what to do.

`beside_limits` and `one_line` are for the numbers and the foreign texts in these lines.
"""


class CRFNetError(Exception):
    """Base of every error that a caller can fix: bad input, a bad file, a bad option."""


class PhotoError(CRFNetError):
    """A photograph that cannot be read or cannot be analysed."""


class ModelError(CRFNetError):
    """A model folder that is incomplete, altered or of another kind than expected."""


class PriorError(CRFNetError):
    """A prior that is absent or describes no shares of families."""


class CurveError(CRFNetError):
    """Samples that describe no camera response."""


class EstimateError(CRFNetError):
    """A document that holds no estimate, or one of a later version."""


class CalibrationError(CRFNetError):
    """An exposure stack that cannot be read as one, or that no camera response explains."""


class CameraError(CRFNetError):
    """A camera that is not in the library, or cannot be read from it, kept in it or used."""


class LutError(CRFNetError):
    """A lookup table that is malformed or cannot be written."""


class ConfigError(CRFNetError):
    """An OpenColorIO config that does not load, validate or convert as it should."""


class PlateError(CRFNetError):
    """A plate or frame sequence that cannot be found, read or written."""


def beside_limits(value: float, *limits: float) -> str:
    """Return a number with two decimals, or up to six where fewer would hide on which side of a limit it lies."""
    decimals = 2
    while decimals < 6 and any(_sides(value, limit) != _sides(round(value, decimals), limit) for limit in limits):
        decimals += 1
    return f"{value:.{decimals}f}"


def one_line(problem: BaseException | str) -> str:
    """Return an error's text on one line; control characters, as a damaged file may bring, become question marks."""
    text = " ".join(str(problem).split())
    return "".join(character if character.isprintable() else "?" for character in text)


def _sides(value: float, limit: float) -> tuple[bool, bool]:
    """Return whether a number is above a limit, and whether it is below."""
    return value > limit, value < limit
