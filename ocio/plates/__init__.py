"""Plates: the frames of a sequence, and the linear EXR files made of them.

frames       names, patterns and sequences of frames: find the files, choose some of them
frame_files  read one frame: its encoded samples, its alpha and its header
linear       linearise frames through a LUT, several at a time
exr          the header and the file of a linear plate
"""
