"""What tests of several folders share, apart from the fixtures in `tests/conftest.py`.

images      write and read image files with OpenImageIO
processes   start a process that Control-C can interrupt
"""
