"""OpenColorIO configs that know a plate's colour space.

plate_color_space   the colour space, added to any config, and the config written once it converts as its LUT does
portable            a small config of profile 2.0 for every host
installed           a plate's colour space in the config that a program starts with, and the way back
"""
