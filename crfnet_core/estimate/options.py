"""The choices of an analysis, apart from the network and the prior."""

from dataclasses import dataclass
from typing import Annotated

from crfnet_core.photograph.metadata import Device
from crfnet_core.statistics.windows import FULL_COVERAGE, POSITIONS_TRIED, WINDOWS_PER_PHOTOGRAPH
from crfnet_core.types import CheckedFields


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
