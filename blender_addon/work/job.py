# SPDX-License-Identifier: GPL-3.0-or-later
"""A job: a plate and its use, gathered before another thread takes over.

Nothing here refers to Blender's data, so a job may travel between threads, and a test may make one by hand.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from crfnet.options import EstimateOptions
    from crfnet_core import ResponseEstimate
    from crfnet_core.colorimetry import Primaries
    from crfnet_core.types import Uint8Array

#: A file name without suffix, split around its last number, which is the frame number.
_FRAME_NUMBER = re.compile(r"(.*?)(\d+)(\D*)")


class ApplyMode(StrEnum):
    """The uses of a response: none yet, nodes, linear EXR files, or LUT files and a config."""

    ESTIMATE = "ESTIMATE"
    NODES = "NODES"
    BAKE = "BAKE"
    EXPORT = "EXPORT"


#: The modes that write no file.
WITHOUT_FILES = (ApplyMode.ESTIMATE, ApplyMode.NODES)


class Anchor(StrEnum):
    """The brightness that gets a fixed linear value."""

    WHITE = "WHITE"
    GRAY = "GRAY"


@dataclass(frozen=True, kw_only=True)
class Plate:
    """The files of a plate, and its names."""

    name: str  # of the file without suffix and frame number: for messages, new files and nodes
    uid: int  # `session_uid` of the image or clip, which finds it again after the run
    file: Path  # of a sequence, one of its frames
    #: Of a sequence the file name before the frame number, the digits of the number, and the name after it: a name may
    #: hold placeholders of its own, so it is not to be read as a pattern.
    numbered: tuple[str, int, str] | None
    color_space: str  # as Blender takes the file
    folder: Path | None  # for new files unless the user chooses one; None for a plate without a file of its own
    has_metadata: bool = True  # whether the file may name its camera; False if it was written from pixels in Blender
    file_state: str = ""  # see `scene.plates.file_state`; empty without a file of its own
    #: The packed file, or the code values (uint8, shape (H, W, 3 or 4)), of an image without a file of its own; `file`
    #: is then only a name. Of a movie, the code values of the frame shown; None above 8 bits.
    content: bytes | Uint8Array | None = field(default=None, repr=False, compare=False)
    shown_frame: int = 0  # of a movie, the number of that frame
    frame_count: int = 0  # of a movie
    #: "STRAIGHT", "PREMUL", "CHANNEL_PACKED" or "NONE", as Blender takes the alpha of the image, whatever its file is
    #: tagged with; empty for clips and where Blender does not show the file, whose alpha then counts.
    alpha_mode: str = ""

    @classmethod
    def from_file(cls, path: Path, *, is_sequence: bool, datablock_name: str, **fields: Any) -> Plate:
        """Return the plate of a file, or of the sequence that the file belongs to, with further fields.

        A file name without a number belongs to no sequence; one of digits alone gives its image's or clip's name.
        """
        number = _FRAME_NUMBER.fullmatch(path.stem) if is_sequence else None
        if number is None:
            return cls(name=path.stem, file=path, numbered=None, **fields)
        before, digits, after = number.groups()
        name = (before.rstrip("._- ") + after) or Path(datablock_name).stem
        return cls(name=name, file=path, numbered=(before, len(digits), after + path.suffix), **fields)


@dataclass(frozen=True, kw_only=True)
class Estimation:
    """The source of the response: a new estimate, or a stored one."""

    options: EstimateOptions
    is_forced: bool  # whether it is estimated even from a plate that is said to be logarithmic or linear
    stored: ResponseEstimate | None = None  # used instead of a new estimate
    primaries: Primaries | None = None  # of the plate, if they are known from `stored`; else its file is read
    origin: str = ""  # of `stored`, in words; empty if it was estimated from the plate


@dataclass(frozen=True, kw_only=True)
class Exposure:
    """The scale of the linear values, which a response alone leaves open."""

    anchor: Anchor  # WHITE: brightness 1 becomes linear 1; GRAY: brightness `gray` becomes linear 0.18
    gray: float  # in (0, 1]
    stops: float  # added on top of the anchor


@dataclass(frozen=True, kw_only=True)
class Output:
    """The use of the response."""

    mode: ApplyMode
    folder: Path | None  # for files; None if none is known
    depth: str  # of baked files: "half" or "float"
    overwrite: bool
    own_files: Mapping[str, str] = field(default_factory=dict)  # those that the plate wrote: path -> `file_state`
    is_composed: bool = False  # whether the compositor puts the render over a plate that it does not show yet
    despite_verdict: bool = False  # whether a response is applied that is not to be trusted


@dataclass(frozen=True, kw_only=True)
class Job:
    """A plate, and what is to be done with it; `config` is the OpenColorIO config that Blender was started with."""

    plate: Plate
    estimation: Estimation
    exposure: Exposure
    output: Output
    config: str


def file_state(path: Path) -> str:
    """Return the name, the size in bytes and the time in seconds of a file, a line each; empty if it is not found.

    The folder does not count, so that a project can be moved.
    """
    try:
        status = path.stat()
    except OSError:
        return ""
    return f"{path.name}\n{status.st_size}\n{status.st_mtime:.0f}"
