"""Tags of a movie's encoding: primaries, transfer function, makers' log curves."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from crfnet_core.photograph.metadata.color_tags import ColorTags, cicp_tags

if TYPE_CHECKING:
    from av import VideoFrame

#: Metadata by FFmpeg's names, in lower case -> a text in it -> the log curve that it names.
LOG_TAGS = {
    "com.arri.camera.colorgammasxs": {"log-c": "ARRI LogC3"},
    "com.panasonic.semi-pro.metadata.xml": {"<capturegamma>v-log</capturegamma>": "Panasonic V-Log"},
}


def color_tags(frame: VideoFrame, metadata: Mapping[str, str]) -> ColorTags:
    """Return primaries and transfer function as the stream tags them, or else the log curve that metadata names."""
    tags = cicp_tags((frame.color_primaries, frame.color_trc))
    texts = {name: "".join(metadata.get(name, "").lower().split()) for name in LOG_TAGS}
    curves = [curve for name, marks in LOG_TAGS.items() for mark, curve in marks.items() if mark in texts[name]]
    if tags.transfer or not curves:
        return tags
    return ColorTags(tags.primaries, curves[0], " and ".join(filter(None, (tags.source, "the maker's entry"))))
