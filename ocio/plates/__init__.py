"""Plates: the frames of a sequence, and the linear EXR made of them.

frames   find the frames of a sequence, choose some, read one
linear   write encoded frames as scene-linear OpenEXR
"""
