"""The options of the pipeline: plain, frozen, and the same for the command and for the add-on."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from crfnet_core.estimate.options import AnalysisOptions
from crfnet_core.photograph.metadata import Device

from .defaults import DEPTHS, LUT_LENGTH, OUTPUT_SPACES, PRIMARIES, PRIORS


@dataclass(frozen=True, kw_only=True)
class EstimateOptions:
    """How responses are estimated.

    Parameters
    ----------
    model : Path or None
        The folder or the name of the model; None for the default model.
    threads : int
        Threads of the network; 0 for as many as there are cores.
    prior : str or Path
        Which kinds of responses to expect: the name of a packaged prior, or a JSON file.
    camera : str or None
        The stored camera whose response is the answer; None to estimate it from the photographs.
    analysis : AnalysisOptions
        How the photographs are analyzed.
    """

    model: Path | None = None
    threads: int = 0
    prior: str | Path = PRIORS[0]
    camera: str | None = None
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
class PlateOptions:
    """How linear plates are written.

    Parameters
    ----------
    depth : {"half", "float"}
        Sample type of the EXR files.
    exposure : float
        Stops by which the linear values are raised, after the anchor.
    gray : float or None
        The anchor: the encoded brightness of a surface that reflects 18 % of the light, which becomes a linear 0.18.
        By default white is the anchor: brightness 1 becomes a linear 1.
    primaries : {"auto", "rec709", "p3", "adobe", "prophoto", "rec2020"}
        The primaries of the encoded plate; "auto" goes by its tags.
    output_space : {"scene_linear", "plate", "ACEScg", "ACES2065-1"}
        The space of the linear values: "scene_linear" is linear Rec.709, "plate" leaves the plate's own primaries.
    overwrite : bool
        Whether existing files may be replaced.
    is_encoded : bool
        Whether OpenEXR plates that do not say how their values are encoded hold encoded values.
    """

    depth: str = DEPTHS[0]
    exposure: float = 0.0
    gray: float | None = None
    primaries: str = PRIMARIES[0]
    output_space: str = OUTPUT_SPACES[0]
    overwrite: bool = False
    is_encoded: bool = False


@dataclass(frozen=True, kw_only=True)
class OutputOptions:
    """Which files are written of an estimate, beside its LUTs, config and document.

    Parameters
    ----------
    lut_length : int
        Entries of the LUTs.
    has_sheet : bool
        Whether the sheet is drawn, which needs matplotlib.
    has_linear : bool
        Whether the photographs are written as linear EXR.
    has_forward : bool
        Whether the response itself is written, too, from light to code values.
    """

    lut_length: int = LUT_LENGTH
    has_sheet: bool = True
    has_linear: bool = True
    has_forward: bool = False
