"""OpenColorIO configs that know a plate's color space.

reference_space    from linear Rec.709 to the scene reference space of any config
file_rules         the files of a plate, by their names
plate_color_space  the color space of a plate, as data and as a part of any config; the plates of a config
plate_views        views that show a scene through the plate's camera
portable           a small config of profile 2.0 for every host, built on portable.ocio
files              load a config of bounded size; write one after checking it against its LUTs
sources            the config that a user names: a file, a built-in name, $OCIO, an installed Blender
looks              the files that an estimate wrote for a plate, read back
derived            a new config: another one with plates added
"""
