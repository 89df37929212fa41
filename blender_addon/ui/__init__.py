# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user sees of the add-on, and the job that is gathered from it.

operators       "Estimate Camera Response", "Apply Camera Response", "Restore OpenColorIO Config"
panel           the sidebar panel of three editors
plate_settings  what can be chosen for one plate
preferences     what is chosen for every file
handlers        what happens when a .blend file is opened
gather          the job of a plate, from its settings and the preferences
"""
