# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators of the sub-panel "More".

add_look      "Add Camera Look" in the compositor
load_lut      "Load Response from LUT"
other_plates  "Apply to Other Plates"
standard_view "Standard View", drawn above the sub-panel
"""
