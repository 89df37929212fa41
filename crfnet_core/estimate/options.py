"""Options with bounds; and the choices of an analysis, apart from the network and the prior."""

from dataclasses import Field, dataclass, fields
from typing import Annotated, Any, ClassVar, get_type_hints

from crfnet_core.errors import CRFNetError
from crfnet_core.photograph.metadata import Device
from crfnet_core.statistics.windows import FULL_COVERAGE, POSITIONS_TRIED, WINDOWS_PER_PHOTOGRAPH
from crfnet_core.types import typed_value


class CheckedFields:
    """Base of dataclasses of options: raises CRFNetError for one of another type, or out of the bounds in its type."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

    def __post_init__(self) -> None:
        hints = get_type_hints(type(self), include_extras=True)
        for each in fields(self):
            object.__setattr__(self, each.name, checked_option(each.name, getattr(self, each.name), hints[each.name]))


def checked_option(name: str, value: Any, kind: Any) -> Any:
    """Return an option as a value of the type in an annotation, as `typed_value`; raise CRFNetError."""
    try:
        return typed_value(value, kind)
    except (TypeError, ValueError) as problem:
        raise CRFNetError("bad_option", name=name, problem=problem) from None


@dataclass(frozen=True, kw_only=True)
class AnalysisOptions(CheckedFields):
    """How photographs are analyzed; raise CRFNetError if an option is of another type or out of range.

    Parameters
    ----------
    use_metadata : bool
        Whether the files' metadata counts: see `crfnet_core.photograph.metadata`.
    device : Device, optional
        The kind of camera, if the user states it; it overrides the files. UNKNOWN is a camera of another kind.
    windows : int
        Windows of each photograph, 1 to `POSITIONS_TRIED`.
    seed : int
        Seed of the choice of windows, 0 or more.
    coverage : int
        Code values, of 256, that a window should hold: see `select_windows`.
    """

    use_metadata: bool = True
    device: Device | None = None
    windows: Annotated[int, (1, POSITIONS_TRIED)] = WINDOWS_PER_PHOTOGRAPH
    seed: int = 0
    coverage: Annotated[int, (0, 256)] = FULL_COVERAGE
