"""OpenColorIO configs that know a plate's colour space.

plate_color_space    the colour space, as data and as a part of any config
portable             a small config of profile 2.0 for every host, built on portable.ocio
files                load a config, and write one after checking it against its LUTs
installed            a plate's colour space in the config that a program reads at its start, and the way back
installation_record  what was done to that config, written down beside it
"""
