"""The encoding of code values that a file states: linear, log, film or video, or none."""

from __future__ import annotations

import re
from enum import StrEnum

from crfnet_core.photograph.metadata.color_tags import profile_transfer
from crfnet_core.photograph.metadata.file_metadata import FileMetadata


class Encoding(StrEnum):
    """The encoding that a file states, other than a picture for a display."""

    LINEAR = "scene-linear"
    LOG = "log"
    FOOTAGE = "film or video"
    MOVIE = "movie"
    UNKNOWN = ""


#: Formats of files that hold no still photographs -> their encoding.
FOOTAGE = {"DPX": Encoding.FOOTAGE, "movie": Encoding.MOVIE}

#: Transfer characteristics of DPX that state no encoding.
_UNSPECIFIC_TRANSFERS = ("", "Undefined", "User defined")

#: Words in lower case of an ICC profile's description, or of DPX's transfer characteristic, that mean linear values.
#: RED's Log3G10 is log.
_LINEAR = r"\blinear\b|\bacescg\b|\baces ?2065|\bscene[- ]?ref|(?<!log3)g10\b|gamma ?1\.0\b"

#: Words that mean log values of whatever version; `profile_transfer` knows the encoding of some.
_LOG = r"\b[scvnf]-?log(?![a-z])|\blog ?c|log3g"

#: Encodings for a display that `profile_transfer` names.
_FOR_DISPLAYS = ("PQ", "HLG")


def encoding_of(metadata: FileMetadata) -> Encoding:
    """Return the encoding that the profile, or DPX's transfer characteristic, states."""
    profile = metadata.profile.casefold()
    if re.search(_LINEAR, profile):
        return Encoding.LINEAR
    transfer = profile_transfer(profile)
    if transfer not in _FOR_DISPLAYS and (transfer or re.search(_LOG, profile)):
        return Encoding.LOG
    return FOOTAGE.get(metadata.file_format, Encoding.UNKNOWN)


def encoding_words(metadata: FileMetadata, encoding: Encoding) -> list[str]:
    """Return the same in words, if the file states any."""
    if encoding == Encoding.MOVIE:
        return ["a frame of a movie"]
    if encoding == Encoding.FOOTAGE and metadata.profile in _UNSPECIFIC_TRANSFERS:
        return [f"{metadata.file_format} files hold {encoding}"]
    name = "transfer tag" if metadata.file_format in FOOTAGE else "profile"
    return [f'its values are {encoding}: so says its {name} "{metadata.profile}"'] if encoding else []
