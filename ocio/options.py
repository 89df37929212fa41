"""The options of the pipeline: plain, frozen, and the same for the command and for the add-on."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.photograph.metadata import Device
from crfnet_core.types import CheckedFields

from .defaults import DEPTHS, MOST_STOPS, OUTPUT_SPACES, PRIMARIES, PRIORS


@dataclass(frozen=True, kw_only=True)
class EstimateOptions(CheckedFields):
    """How responses are estimated."""

    model: Path | None = None  # the folder or the name of the model; None for the default model
    threads: int = 0  # of the network; 0 for as many as there are cores
    prior: Path | str = PRIORS[0]  # which responses to expect: the name of a packaged prior, or a JSON file
    camera: str | None = None  # the stored camera whose response is the answer; None to estimate it
    analysis: AnalysisOptions = field(default_factory=AnalysisOptions)


def stated_device(name: str | None) -> Device | None:
    """Return the device of a name in `crfnet.defaults.DEVICES`; None if the user states none."""
    if name is None:
        return None
    return Device.UNKNOWN if name == "other" else Device(name)


def device_name(device: Device | None) -> str | None:
    """Return the name in `crfnet.defaults.DEVICES` of a stated device."""
    return "other" if device is Device.UNKNOWN else device


@dataclass(frozen=True, kw_only=True)
class PlateOptions(CheckedFields):
    """How linear plates are written."""

    depth: Annotated[str, DEPTHS] = DEPTHS[0]  # sample type of the EXR files
    exposure: Annotated[float, (-MOST_STOPS, MOST_STOPS)] = 0.0  # stops, added after the anchor
    gray: float | None = None  # encoded brightness that becomes a linear 0.18; by default 1 becomes a linear 1
    primaries: Annotated[str, PRIMARIES] = PRIMARIES[0]  # of the encoded plate; "auto" goes by its tags
    output_space: Annotated[str, OUTPUT_SPACES] = OUTPUT_SPACES[0]
    overwrite: bool = False  # whether existing files may be replaced
    is_encoded: bool = False  # accepts OpenEXR plates that do not state their encoding, and tags that say linear


@dataclass(frozen=True, kw_only=True)
class OutputOptions(CheckedFields):
    """Which files an estimate has beside its LUTs, config and document."""

    has_sheet: bool = True  # the picture, which needs matplotlib
    has_linear: bool = True  # the photographs as linear EXR
    has_forward: bool = False  # the response itself, from light to code values
