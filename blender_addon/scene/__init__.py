# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's data, read and changed; in Blender's own thread only.

plates             the image or clip that the user means, and its code values on disk
packed_images      pixels without a file of their own: packed and painted images, the frame of a movie
stored_estimate    the estimate as a custom property of its image or clip
apply              the changes of a completed job
node_group         the inverse response as a compositor node group
look_group         the response as a compositor node group: from scene-linear light to the look of the plate
curve_nodes        functions of colors as RGB Curves nodes
node_building      nodes from which the two groups are built
compositor         the place of the node group in the compositor
ready_comp         the render over a plate, at the output and in a viewer
node_links         the nodes behind a node
code_values        the copy of a plate that the compositor reads, in place of the pixels that Blender linearizes
color_management   the OpenColorIO config that this Blender runs on, and the scene's view transform
color_space_names  color spaces of a file that was made under another config
"""
