# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators of the sub-panel "More".

looks         "Add Camera Look" in the compositor; "Standard View", drawn above the sub-panel
load_lut      "Load Response from LUT"
other_plates  "Apply to Other Plates"
"""
