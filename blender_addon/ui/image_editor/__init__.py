# SPDX-License-Identifier: GPL-3.0-or-later
"""Tools of the Image Editor that the other editors lack.

comparison   the linear plate in the place of the plate, for looking only
image_tools  before and after, the way back from a bake, the eyedropper for gray, frames taken for UDIM tiles
"""
