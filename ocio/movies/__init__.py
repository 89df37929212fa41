"""Movies: frames as code values, decoded in order through PyAV (FFmpeg's libraries), an optional dependency.

source      a name on the command line to frames: of a movie, of a sequence, or a single file; a choice of them
frames      the frames of a movie as a source of plates
stream      the description of a movie: its picture, its frames, its metadata, its color tags
cut_files   files that end before they say
library     PyAV and its absence; which files are movies; the profile of Dolby Vision
"""
