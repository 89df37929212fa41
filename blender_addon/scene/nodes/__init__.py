# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's nodes in compositors and shaders.

compositor   the place of the node group in a compositor or shader
ready_comp   the render over a plate, at the output and in a viewer
links        the node trees, the nodes behind a node, and what the panel warns of in them
plate_group  the inverse response as a node group
look_group   the response as a node group: from scene-linear light to the look of the plate
curves       functions of colors as RGB Curves nodes, in as many parts as their precision takes
building     nodes from which the two groups are built
"""
