# SPDX-License-Identifier: GPL-3.0-or-later
"""What the add-on reads from Blender's data and changes in it; in Blender's own thread only.

plates             which image or clip is meant, and where its code values lie on disk
packed_images      which images have no file of their own, and the packed file or the code values of these
movie_frames       the frame of a movie that an editor shows, as code values
stored_estimate    the estimate as a custom property of its image or clip
apply              what a completed job changes
node_group         the inverse response as a compositor node group
look_group         the response as a compositor node group: from scene-linear light to the look of the plate
node_building      nodes from which the two groups are built
compositor         where the node group goes in the compositor
node_links         which nodes lie behind a node
code_values        the copy of a plate that the compositor reads, in place of what Blender linearizes
color_management   the OpenColorIO config that this Blender runs on
color_space_names  color spaces of a file that was made under another config
"""
