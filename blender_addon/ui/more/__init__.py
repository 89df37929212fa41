# SPDX-License-Identifier: GPL-3.0-or-later
"""The sub-panel "More" and its operators.

panel         the sub-panel
add_look      "Add Camera Look" in the compositor
load_lut      "Load Response from LUT"
match_view    "Match the Photograph", drawn above the sub-panel
other_plates  "Apply to Other Plates"
"""
