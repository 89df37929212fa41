"""Movies: frames as code values, decoded in order through PyAV (FFmpeg's libraries), an optional dependency.

source      a name on the command line to frames: of a movie, of a sequence, or a single file
frames      the frames of a movie as a source of plates
selection   the few frames from which a response is estimated
stream      the description of a movie: its picture, its frames, its metadata, its color tags
dolby_vision  the profile that is refused
library     PyAV and its absence; which files are movies
"""
