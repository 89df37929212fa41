"""Plates in anybody's config: a studio's, OpenColorIO's own, Blender's.

sources     which config a user means: a file, a built-in name, $OCIO, an installed Blender's
looks       what `crfnet estimate` wrote for a plate, read back
rules       which files of a plate get a rule
plates      the plates of a config, and what a change made of it
aces_check  a plate's conversion, checked in ACES2065-1
additions   put plates in
removal     take plates out
overlay     a config of the plates alone, for OpenColorIO's own merging
"""
