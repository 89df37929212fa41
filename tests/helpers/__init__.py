"""What the tests of several folders share, apart from the fixtures in `tests/conftest.py`.

images         write and read image files with OpenImageIO
crafted_files  PNG, TIFF and JPEG files made by hand, whose headers say what no image writer would
processes      start a process that Control-C can interrupt
"""
