# SPDX-License-Identifier: GPL-3.0-or-later
"""Tools of the Image Editor that the other editors lack.

comparison   the linear plate in the place of the plate, for looking only
image_tools  before and after, the eyedropper for gray, and frames that Blender took for UDIM tiles
"""
