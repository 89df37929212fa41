"""Plates: the frames of a sequence, and the linear EXR files made of them.

frames        the frames that a name stands for: find the files, choose some of them
frame_pattern names with a placeholder for the frame number
frame_numbers ranges of frame numbers, read and written
frame_files   read one frame: its encoded samples, its alpha and its header; the protocol of frame sources
primaries     the primaries of an encoded plate, and the space of its linear values
light         the meaning of a linear plate's numbers, its exposure, and whether finished frames have the same
linear        linearize frames through a LUT, several at a time in bounded memory
exr           the header and the file of a linear plate
"""
