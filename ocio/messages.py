"""Every sentence that the errors of `ocio` say, each once, by its code; see `crfnet_core.messages` for the rules."""

from collections.abc import Mapping

SENTENCES: Mapping[str, str] = {
    # movies
    "dolby_vision": "{path}: is Dolby Vision of profile {profile}, whose samples only its own decoder shows; give a"
    " version in SDR",
    "frame_undecodable": "{path}: frame {frame} cannot be decoded; copy the movie again, or extract its frames: {line}",
    "movie_changes": "{path}: frame {frame} is {form}, the first {first}; cut the movie where it changes",
    "movie_interlaced": "{path}: is interlaced, each frame mixes two moments; deinterlace it and linearize the frames:"
    " {line} (leave out its filter if both fields show the same moment)",
    "movie_too_large": "{path}: claims {width} x {height} pixels; crop it",
    "movie_undecodable": "{path}: cannot be decoded ({reason}); copy it again, or extract its frames: {line}",
    "no_video": "{path}: holds no video that FFmpeg decodes; give a movie with a picture",
    "pyav_missing": "{path}: is a movie, which needs PyAV: pip install 'crfnet[video]', or extract its frames: {line}",
    # plates
    "no_such_frames": "{path}: there are {frames}; check the name and the frames",
}
