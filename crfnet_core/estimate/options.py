"""The choices of an analysis, apart from the network and the prior."""

from dataclasses import dataclass

from crfnet_core.photograph.metadata import Device
from crfnet_core.statistics.windows import FULL_COVERAGE, WINDOWS_PER_PHOTOGRAPH


@dataclass(frozen=True, kw_only=True)
class AnalysisOptions:
    """How photographs are analyzed.

    Parameters
    ----------
    use_metadata : bool
        Whether the files' metadata counts: see `crfnet_core.photograph.metadata`.
    device : Device, optional
        The kind of camera, if the user states it; it overrides the files. UNKNOWN is a camera of another kind.
    windows : int
        Windows of each photograph.
    seed : int
        Seed of the choice of windows.
    coverage : int
        Code values, of 256, that a window should hold: see `select_windows`.
    """

    use_metadata: bool = True
    device: Device | None = None
    windows: int = WINDOWS_PER_PHOTOGRAPH
    seed: int = 0
    coverage: int = FULL_COVERAGE
