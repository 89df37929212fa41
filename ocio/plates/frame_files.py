"""Read one frame of a plate: its encoded samples, its alpha and its header; or its color tags alone."""

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol, TypeAlias

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

from crfnet_core.photograph.image_io import MAX_PIXELS, first_line, oiio_message, read_codes, read_metadata
from crfnet_core.photograph.image_io.header_checks import channel_names, text_attribute
from crfnet_core.photograph.metadata.color_tags import ColorTags
from crfnet_core.photograph.metadata.header_colors import header_color_tags
from crfnet_core.response.curve import MOST_BRIGHTNESS, are_undivided_codes
from crfnet_core.types import Float32Array

from ..errors import PlateError

#: Names of the one channel of a gray picture, and colorInteropID of encoded values, as the Color Interop Forum has it.
GRAY, ENCODED = ({"Y"}, {"R"}), re.compile(r"(srgb|g\d\d|pq|hlg)_\w+_(scene|display)")


@dataclass(frozen=True, eq=False)
class EncodedFrame:
    """The samples of a frame before its linearization."""

    samples: NDArray[Any]  # (H, W, 3): codes, or encoded values as float32 in [0, 1] and beyond; not times alpha
    largest: int  # the code of brightness 1; 1 for floats
    alpha: Float32Array | None  # (H, W): coverage in [0, 1], or other data
    header: Any  # the file's OpenImageIO.ImageSpec
    color: ColorTags = field(default_factory=ColorTags)
    is_coverage: bool = True  # whether linear colors are multiplied by alpha


#: Returns a frame; raises a `CRFNetError` if it cannot be read.
FrameLoader: TypeAlias = Callable[[], EncodedFrame]


class FrameSource(Protocol):
    """Frames by number: the files of a sequence, a single file, or a movie."""

    @property
    def paths(self) -> tuple[Path, ...]:
        """The file of each frame, or the one file that holds them all."""

    @property
    def numbers(self) -> tuple[int, ...]:
        """The number of each frame, ascending; empty for a single file, which has none."""

    @property
    def missing(self) -> tuple[int, ...]:
        """Numbers of frames that are asked for and not there."""

    def loaders(self, positions: Sequence[int]) -> Iterator[FrameLoader]:
        """Yield a loader of each frame, for ascending positions in `numbers`; it may be called in any thread."""


@dataclass(frozen=True, eq=False)
class FirstFrame:
    """The first frame that can be read, its position in the source and its file, so that it is not read twice."""

    position: int
    path: Path
    frame: EncodedFrame


def first_frame(sequence: FrameSource) -> FirstFrame | None:
    """Return the first frame that can be read; None if all fail, each with an error of its own."""
    for position, load in enumerate(sequence.loaders(range(max(1, len(sequence.numbers))))):
        with suppress(Exception, SystemExit, GeneratorExit):  # all but an interruption
            return FirstFrame(position, frame_path(sequence, position), load())
    return None


def frame_path(sequence: FrameSource, position: int) -> Path:
    """Return the file of a frame; all frames of a movie have one file."""
    return sequence.paths[min(position, len(sequence.paths) - 1)]


def read_frame(path: Path, *, is_encoded: bool = False, is_associated: bool | None = None) -> EncodedFrame:
    """Return the encoded samples of one frame: of a file that `read_photo` can read, or of OpenEXR with encoded values.

    `is_encoded` accepts OpenEXR that does not state its encoding. `is_associated`: whether the samples are divided by
    alpha, by default as the file says. Raises as `read_photo` does, or a PlateError.
    """
    if path.suffix.lower() == ".exr":
        return _read_encoded_exr(path, is_encoded=is_encoded, is_divided=is_associated is not False)
    values = read_codes(path)
    alpha = None
    if values.alpha is not None:
        alpha = np.divide(values.alpha, np.float32(values.largest), dtype=np.float32)
        values = values if is_associated is None else replace(values, is_associated=is_associated)
    samples, largest = (values.pixels(), 1) if values.is_associated else (values.codes, values.largest)
    return EncodedFrame(samples, largest, alpha, values.header, values.metadata.color)


def read_color_tags(path: Path, *, is_encoded: bool = False) -> ColorTags:
    """Return the color tags in the header of a frame; it accepts and refuses the same files as `read_frame`."""
    if path.suffix.lower() != ".exr":
        return read_metadata(path).color
    with _opened_exr(path, is_encoded=is_encoded) as source:
        return header_color_tags(source.spec(), "OpenEXR")


@contextmanager
def _opened_exr(path: Path, *, is_encoded: bool) -> Iterator[Any]:
    """Yield an OpenEXR file as an OpenImageIO.ImageInput, or refuse it."""
    if path.exists() and not path.is_file():  # a pipe would block
        raise PlateError("not_a_file", path=path)
    source, problem = oiio.ImageInput.open(str(path)), oiio_message()
    if source is None:
        raise PlateError("exr_unreadable", path=path, problem=first_line(problem))
    try:
        _seek_color(source)
        _check_encoded_exr(path, source.spec(), is_encoded=is_encoded)
        yield source
    finally:
        source.close()


def _seek_color(source: Any) -> None:
    """Go to the first part of an OpenEXR file that has R, G and B, if there is one: depth or a mask may come first."""
    part = 0
    while source.seek_subimage(part, 0):
        if set(channel_names(source.spec())) >= set("RGB"):
            return
        part += 1
    source.seek_subimage(0, 0)
    oiio_message(source)


def _read_encoded_exr(path: Path, *, is_encoded: bool, is_divided: bool) -> EncodedFrame:
    """Return the encoded values in an OpenEXR file, divided by its alpha or as stored."""
    with _opened_exr(path, is_encoded=is_encoded) as source:
        header = source.spec()
        channels = _color_channels(header)
        part, needed = source.current_subimage(), {*channels, *_alpha_channel(header)}  # others may be many
        planes = {channel: source.read_image(part, 0, channel, channel + 1, "float") for channel in needed}
        problem = oiio_message(source)
    if problem or any(plane is None for plane in planes.values()):
        raise PlateError("exr_damaged", path=path, problem=first_line(problem))
    if faulty := np.count_nonzero(np.any([~np.isfinite(plane) for plane in planes.values()], axis=0)):
        raise PlateError("exr_not_finite", path=path, count=faulty)
    samples = np.concatenate([planes[channel] for channel in channels], axis=2)  # (H, W, 3)
    if are_undivided_codes(samples):
        raise PlateError("exr_codes", path=path, most=MOST_BRIGHTNESS)
    alpha = next((planes[channel] for channel in _alpha_channel(header)), None)  # (H, W, 1)
    if alpha is not None and is_divided:
        samples = np.divide(samples, alpha, out=np.zeros_like(samples), where=alpha != 0)
    coverage = None if alpha is None else alpha[..., 0]
    return EncodedFrame(samples, 1, coverage, header, header_color_tags(header, "OpenEXR"))


def _color_channels(header: Any) -> list[int]:
    """Return the channels of red, green and blue, or three times the gray one; none where there is neither."""
    names = channel_names(header)
    colors = set(names) - {"A"}
    if colors >= set("RGB"):
        return [names.index(name) for name in "RGB"]
    return [names.index(min(colors))] * 3 if colors in GRAY else []


def _alpha_channel(header: Any) -> list[int]:
    """Return the channel of alpha, or none; OpenImageIO takes that of any layer for it, such as a matte's."""
    return [number for number, name in enumerate(channel_names(header)) if name == "A"]


def _check_encoded_exr(path: Path, header: Any, *, is_encoded: bool) -> None:
    """Refuse an OpenEXR file that is or may be linear, is too large or deep, or holds no RGB or gray picture."""
    space = text_attribute(header, "colorInteropID")
    if space.startswith("lin_"):
        raise PlateError("plate_is_linear", path=path, space=space)
    if header.image_pixels() * max(header.nchannels, 4) > 4 * MAX_PIXELS:  # all are decompressed
        size = {"width": header.width, "height": header.height, "channels": header.nchannels}
        raise PlateError("exr_samples", path=path, **size)
    channels = _color_channels(header)
    kinds = {str(header.channelformat(channel)) for channel in (*channels, *_alpha_channel(header))}
    if header.deep or not channels or not kinds <= {"half", "float"}:
        raise PlateError("exr_channels", path=path, channels=", ".join(channel_names(header)))
    if not ENCODED.fullmatch(space) and not is_encoded:
        raise PlateError("exr_untagged", path=path)
