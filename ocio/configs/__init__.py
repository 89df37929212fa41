"""OpenColorIO configs that know a plate's colour space.

reference_space      from linear Rec.709 to the scene reference space of any config
file_rules           which files are a plate's, by their names
plate_color_space    the colour space, as data and as a part of any config
plate_views          views that show a scene through the plate's camera
portable             a small config of profile 2.0 for every host, built on portable.ocio
files                load a config, and write one after checking it against its LUTs
installation_record  what was done to a config, written down beside it, and its backup
installed            a plate's colour space in the config that a program reads at its start, and the way back
studio               plates in anybody's config: put in, listed, taken out, or as an overlay
"""
