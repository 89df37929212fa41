# SPDX-License-Identifier: GPL-3.0-or-later
"""What the Image Editor has and the other editors do not.

analyzed_windows  the windows that the response was estimated from, outlined over the plate
comparison        the linear plate in the place of the plate, for looking only
image_tools       before and after, the eyedropper for gray, and frames that Blender took for UDIM tiles
"""
