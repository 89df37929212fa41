# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's data, read and changed; in Blender's own thread only.

plates             the image or clip that the user means, and its code values on disk
packed_images      pixels without a file of their own: packed and painted images, the frame of a movie
stored_estimate    the estimate as a custom property of its image or clip
apply              the changes of a completed job
nodes              the add-on's nodes in compositors and shaders
code_values        the copy of a plate that nodes read, in place of the pixels that Blender linearizes
color_management   the OpenColorIO config that this Blender runs on, and the scene's view transform
color_space_names  color spaces of a file that was made under another config
"""
