# SPDX-License-Identifier: GPL-3.0-or-later
"""What the sub-panel "More" offers beside the estimate.

panel         the sub-panel
add_look      "Add Camera Look" in the compositor
load_lut      "Load Response from LUT"
other_plates  "Apply to Other Plates"
"""
