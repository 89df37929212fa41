"""The options of the pipeline: plain, frozen, and the same for the command and for the add-on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from .defaults import DEPTHS, LUT_LENGTH, OUTPUT_SPACES, PRIMARIES, PRIORS, WINDOWS


@dataclass(frozen=True, kw_only=True)
class EstimateOptions:
    """How responses are estimated.

    Parameters
    ----------
    model : Path or None
        The folder or the name of the model; None for the default model.
    threads : int
        Threads of the network; 0 for as many as there are cores.
    windows : int
        Windows cut from each photograph.
    seed : int
        Seed of the choice of windows.
    prior : str or Path
        Which kinds of responses to expect: the name of a packaged prior, or a JSON file.
    use_metadata : bool
        Whether what the files say of their making counts.
    device : str or None
        What took them, one of `crfnet.defaults.DEVICES`, as a person knows it; None to go by the files.
    camera : str or None
        The stored camera whose response is the answer; None to estimate it from the photographs.
    """

    model: Path | None = None
    threads: int = 0
    windows: int = WINDOWS
    seed: int = 0
    prior: str | Path = PRIORS[0]
    use_metadata: bool = True
    device: str | None = None
    camera: str | None = None


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
