"""Photographs: read from files, with their metadata.

image_io      the one reader of image files
photo         a photograph's code values, of a file or an array
yuv           YUV to RGB, for movies and AVIF
orientation   quarter turns: pictures upright
metadata      the origin of a file: device, editor, and its primaries
recognition   inputs that are not camera photographs: log footage, limited range, tagged encodings
"""
