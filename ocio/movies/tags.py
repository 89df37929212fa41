"""Tags of a movie's encoding: primaries, transfer function, makers' log curves, Dolby Vision."""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from typing import TYPE_CHECKING

from crfnet_core.photograph.metadata.color_tags import ColorTags, cicp_tags

if TYPE_CHECKING:
    from av import VideoFrame
    from av.video.stream import VideoStream

#: Metadata by FFmpeg's names, in lower case -> a text in it -> the log curve that it names.
LOG_TAGS = {
    "com.arri.camera.colorgammasxs": {"log-c": "ARRI LogC3"},
    "com.panasonic.semi-pro.metadata.xml": {"<capturegamma>v-log</capturegamma>": "Panasonic V-Log"},
}

#: The profile of Dolby Vision whose samples are IPTPQc2: neither YCbCr nor for an ordinary display.
IPT_PROFILE = 5


def color_tags(frame: VideoFrame, metadata: Mapping[str, str]) -> ColorTags:
    """Return primaries and transfer function as the stream tags them, or else the log curve that metadata names."""
    tags = cicp_tags((frame.color_primaries, frame.color_trc))
    texts = {name: "".join(metadata.get(name, "").lower().split()) for name in LOG_TAGS}
    curves = [curve for name, marks in LOG_TAGS.items() for mark, curve in marks.items() if mark in texts[name]]
    if tags.transfer or not curves:
        return tags
    return ColorTags(tags.primaries, curves[0], " and ".join(filter(None, (tags.source, "the maker's entry"))))


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
