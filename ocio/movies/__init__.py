"""Movies: their frames by number, as code values, through PyAV (FFmpeg's libraries), which is an optional dependency.

source      a name on the command line to frames: those of a movie, of a sequence, or a single file
frames      the frames of a movie as a source of plates
selection   the few frames from which a response is estimated
header      what becomes of a movie's metadata: the header of a frame, and evidence beside its pixels
decoding    frames by number: seek to the key frame before, decode from there
stream      what a movie says of its pictures, read once
index       the times of all frames, without decoding them
conversion  YUV to RGB
color       how streams code RGB: matrix and range
log_tags    what makers write of their log curves into movies
timecode    SMPTE timecode, counted on from frame to frame
library     PyAV and its absence; which files are movies
"""
