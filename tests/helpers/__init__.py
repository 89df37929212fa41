"""What the tests of several folders share, apart from the fixtures in `tests/conftest.py`.

images         write and read image files with OpenImageIO
crafted_files  PNG, TIFF and JPEG files made by hand, whose headers say what no image writer would
no_sockets     run a command that the kernel kills as soon as it opens a socket
processes      start a process that Control-C can interrupt
configs        a plate's colour space, and pixels through OpenColorIO
folders        what lies in a folder
plates         plates to linearise, and what became of them
refusals       errors by their kind, code and facts
posteriors     evidence, and a small bank of responses, whose posteriors can be worked out by hand
"""
