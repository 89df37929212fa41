"""The profile of Dolby Vision: samples of profile 5 are IPTPQc2, which no ordinary decoder turns into RGB."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from av.video.stream import VideoStream

#: The profile of Dolby Vision whose samples are IPTPQc2: neither YCbCr nor for an ordinary display.
IPT_PROFILE = 5


def dolby_vision_profile(stream: VideoStream) -> int:
    """Return the profile of Dolby Vision, or 0: of the box that FFmpeg would write, as PyAV does not give it."""
    import av

    if stream.codec_context.codec.canonical_name != "hevc":
        return 0
    header, options = BytesIO(), {"movflags": "empty_moov", "strict": "unofficial"}
    try:
        with av.open(header, "w", format="mp4", options=options) as container:
            container.add_stream_from_template(stream)
            container.start_encoding()
            content = header.getvalue()
    except (av.FFmpegError, ValueError):
        return 0
    at = content.find(b"dvcC")
    return content[at + 6] >> 1 if at >= 0 else 0
