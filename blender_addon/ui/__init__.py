# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user sees of the add-on, and the job that is gathered from it.

operators       "Estimate Camera Response", "Apply Camera Response", "Cancel"
operator_base   what operators share: when they can run, the plate that a script names, how they report a problem
running         the one run that is under way, and how its progress is shown
panel           the sidebar panel and the menu entries of three editors
estimate_box    what the panel shows of an estimate
image_editor    what only the Image Editor has: before and after, the eyedropper for gray
plate_settings  what can be chosen for one plate
preferences     what is chosen for every file
more            the sub-panel "More": the look of the camera, other plates
handlers        what happens when a .blend file is opened or saved, and at undo
gather          the job of a plate, from its settings and the preferences
"""
