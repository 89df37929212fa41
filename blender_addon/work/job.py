# SPDX-License-Identifier: GPL-3.0-or-later
"""A job: everything that is known of a plate and of what is to be done with it, before another thread takes over.

Nothing here refers to Blender's data, so a job may travel between threads, and a test may make one by hand.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

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

#: Environment variables that name Blender's OpenColorIO config; Blender 4.5 knows the first only. Blender 5.2 sets it
#: itself, so a Blender that is started must not inherit them.
CONFIG_VARIABLES = ("OCIO", "BLENDER_OCIO")


class Anchor(StrEnum):
    """Which brightness has a given linear value."""

    WHITE = "WHITE"
    GRAY = "GRAY"


@dataclass(frozen=True, kw_only=True)
class Plate:
    """The files of a plate, and its names.

    Parameters
    ----------
    name : str
        The name of the file without suffix and frame number: for messages, new files and nodes.
    uid : int
        The `session_uid` of the plate's image or clip, by which it is found again after the run.
    file : Path
        The file; of a sequence, its pattern with a placeholder for the frame number, like ``shot.%04d.png``.
    pattern : str
        The file names with ``*`` for the frame number, like ``shot.*.png``.
    numbered : tuple of (str, int, str), or None
        Of a sequence the file name before the frame number, the digits of the number, and the name after it. A name may
        hold placeholders of its own, so `file` is not to be read as a pattern again.
    color_space : str
        The color space that Blender takes the file for.
    folder : Path or None
        The folder for new files unless the user chooses one; None for a plate without a file of its own.
    has_metadata : bool
        Whether the file may say how it was made; not if it was written from pixels in Blender.
    file_state : str
        The file as it was when the job was gathered, see `scene.plates.file_state`; empty without a file of its own.
    content : bytes, ndarray of uint8 with shape (H, W, 3 or 4), or None
        The packed file, or the code values, of an image without a file of its own; `file` is then only a name. Of a
        movie, the code values of the frame shown; None above 8 bits.
    shown_frame, frame_count : int
        Of a movie, the number of that frame and how many there are; otherwise 0.
    alpha_mode : {"STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE", ""}
        How Blender takes the alpha of the image, whatever its file says; empty for clips and for what Blender does not
        show, where the file counts.
    """

    name: str
    uid: int
    file: Path
    pattern: str
    numbered: tuple[str, int, str] | None
    color_space: str
    folder: Path | None
    has_metadata: bool = True
    file_state: str = ""
    content: bytes | Uint8Array | None = field(default=None, repr=False, compare=False)
    shown_frame: int = 0
    frame_count: int = 0
    alpha_mode: str = ""

    @property
    def is_sequence(self) -> bool:
        """Whether `file` is the pattern of a sequence."""
        return self.numbered is not None

    @property
    def has_frames(self) -> bool:
        """Whether the plate is a sequence or a movie."""
        return self.is_sequence or self.frame_count > 0

    @classmethod
    def of_file(
        cls,
        path: Path,
        *,
        is_sequence: bool,
        datablock_name: str,
        uid: int,
        color_space: str,
        folder: Path | None,
        has_metadata: bool = True,
        file_state: str = "",
        content: bytes | Uint8Array | None = None,
        shown_frame: int = 0,
        frame_count: int = 0,
        alpha_mode: str = "",
    ) -> Plate:
        """Return the plate of a file, or of the sequence that the file belongs to.

        A file name without a number belongs to no sequence. If the frame number is the whole file name, the plate has
        the name of its image or clip.
        """
        number = _FRAME_NUMBER.fullmatch(path.stem) if is_sequence else None
        name, pattern, file, numbered = path.stem, path.name, path, None
        if number is not None:
            before, digits, after = number.groups()
            name = (before.rstrip("._- ") + after) or Path(datablock_name).stem
            pattern = f"{before}*{after}{path.suffix}"
            file = path.with_name(f"{before}%0{len(digits)}d{after}{path.suffix}")
            numbered = (before, len(digits), after + path.suffix)
        return cls(
            name=name,
            uid=uid,
            file=file,
            pattern=pattern,
            numbered=numbered,
            color_space=color_space,
            folder=folder,
            has_metadata=has_metadata,
            file_state=file_state,
            content=content,
            shown_frame=shown_frame,
            frame_count=frame_count,
            alpha_mode=alpha_mode,
        )


@dataclass(frozen=True, kw_only=True)
class Estimation:
    """Where the response of the plate comes from.

    Parameters
    ----------
    options : EstimateOptions
        How it is estimated.
    is_forced : bool
        Whether it is estimated even if the plate is said to be logarithmic or linear.
    stored : ResponseEstimate or None
        An earlier estimate, which is used instead of a new one.
    primaries : Primaries or None
        Those of the plate, if they are known from `stored`; otherwise its file is read.
    origin : str
        Where `stored` comes from, in words; empty if it was estimated from the plate.
    """

    options: EstimateOptions
    is_forced: bool
    stored: ResponseEstimate | None = None
    primaries: Primaries | None = None
    origin: str = ""


@dataclass(frozen=True, kw_only=True)
class Exposure:
    """The scale of the linear values, which a response alone leaves open.

    Parameters
    ----------
    anchor : Anchor
        WHITE: brightness 1 becomes linear 1; GRAY: brightness `gray` becomes linear 0.18.
    gray : float
        The brightness of middle gray in the plate, in (0, 1]; for the anchor GRAY only.
    stops : float
        Stops added on top of the anchor.
    """

    anchor: Anchor
    gray: float
    stops: float


@dataclass(frozen=True, kw_only=True)
class Output:
    """What becomes of the response.

    Parameters
    ----------
    mode : ApplyMode
        The way to apply it.
    folder : Path or None
        The folder for files; None if none is known.
    depth : {"half", "float"}
        The samples of baked files.
    overwrite : bool
        Whether existing files may be replaced.
    despite_verdict : bool
        Whether a response is applied that is not to be trusted.
    """

    mode: ApplyMode
    folder: Path | None
    depth: str
    overwrite: bool
    despite_verdict: bool = False


@dataclass(frozen=True, kw_only=True)
class Job:
    """A plate, and what is to be done with it; `config` is the OpenColorIO config that Blender was started with."""

    plate: Plate
    estimation: Estimation
    exposure: Exposure
    output: Output
    config: str
