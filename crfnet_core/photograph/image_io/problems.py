"""The errors of files that cannot be decoded, and OpenImageIO's messages."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import OpenImageIO as oiio

from crfnet_core.errors import PhotoError, one_line

#: Parts of messages by which decoders refuse sound files of a coding that they do not know.
_UNSUPPORTED = (
    *("support is not configured", "is not implemented", "not supported", "nsupported"),
    "JxlDecoderImageOutBufferSize failed",  # JPEG XL with spot colors, or CMYK
)


def damaged(path: Path, kind: str, problem: str) -> PhotoError:
    """Return the error of a file that cannot be decoded, with the first line of the decoder's message."""
    is_unsupported = any(words in problem for words in _UNSUPPORTED)
    code = "coding_not_read" if is_unsupported else "damaged"
    return PhotoError(code, path=path, kind=kind, problem=first_line(problem))


def oiio_message(source: Any = oiio) -> str:
    """Return OpenImageIO's last message, of an open file or else of the library, on plain lines."""
    try:
        problem = str(source.geterror())
    except UnicodeDecodeError as failure:
        problem = failure.object.decode(errors="replace")
    return "\n".join(map(one_line, problem.split("\n")))


def first_line(problem: str) -> str:
    """Return the first line of a decoder's message."""
    return problem.strip().partition("\n")[0] or "no reason is given"
