"""Photographs: read from files, with their metadata.

image_io      the one reader of image files
photo         a photograph's code values, the integer samples of a file, and turns
arrays        pixels from the arrays of NumPy, Pillow and OpenCV
camera_raw    the light of camera raw files, and the JPEG in them
yuv           YUV to RGB, for movies and AVIF
metadata      the origin of a file: device, editor, encoding, color tags
thumbnail     a photograph's scene in 16 x 16 cells
recognition   inputs that are not camera photographs: log footage, limited range, tagged encodings
"""
