# SPDX-License-Identifier: GPL-3.0-or-later
"""What the Image Editor has and the other editors do not.

comparison   the linear plate in the place of the plate, for looking only
image_tools  before and after, the eyedropper for gray, and frames that Blender took for UDIM tiles
"""
