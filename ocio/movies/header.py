"""What becomes of a movie's metadata: the header of a frame, for the EXR, and the evidence beside its pixels."""

from __future__ import annotations

from typing import Any

import OpenImageIO as oiio

from crfnet_core.photograph.metadata.file_metadata import LONGEST_TEXT, FileMetadata

from .stream import MovieStream

#: What a movie's frames have as `FileMetadata.file_format`.
FILE_FORMAT = "movie"

#: FFmpeg's names, in lower case, of the camera's maker, its model and its firmware; the first one found counts.
MAKES = ("com.apple.quicktime.make", "com.android.manufacturer", "make")
MODELS = ("com.apple.quicktime.model", "com.android.model", "model")
FIRMWARE = ("com.apple.quicktime.software",)


def frame_header(movie: MovieStream, number: int) -> Any:
    """Return the header of a frame: size, pixel aspect, frame rate, its timecode, maker and model.

    Parameters
    ----------
    movie : MovieStream
        See `read_stream`.
    number : int
        Number of the frame, from 1.

    Returns
    -------
    OpenImageIO.ImageSpec
        With OpenImageIO's names of the attributes.
    """
    header = oiio.ImageSpec(movie.width, movie.height, 3, oiio.UINT16)
    header.attribute("PixelAspectRatio", float(movie.pixel_aspect))
    if movie.rate:
        header.attribute("FramesPerSecond", oiio.TypeRational, movie.rate.as_integer_ratio())
    if movie.timecode:
        header.attribute("smpte:TimeCode", oiio.TypeTimeCode, movie.timecode.later(number - 1).packed)
    metadata = movie_metadata(movie)
    for name, text in (("Make", metadata.make), ("Model", metadata.model)):
        if text:
            header.attribute(name, text)
    return header


def movie_metadata(movie: MovieStream) -> FileMetadata:
    """Return what a movie says beside its pixels."""
    return FileMetadata(
        width=movie.width,
        height=movie.height,
        make=_first(movie, MAKES),
        model=_first(movie, MODELS),
        software=_first(movie, FIRMWARE),
        file_format=FILE_FORMAT,
        color=movie.color,
    )


def _first(movie: MovieStream, names: tuple[str, ...]) -> str:
    """Return the printable characters of the first text found."""
    text = next((movie.metadata[name] for name in names if name in movie.metadata), "")
    return "".join(filter(str.isprintable, text[:LONGEST_TEXT])).strip()
