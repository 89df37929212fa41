# SPDX-License-Identifier: GPL-3.0-or-later
"""The interface of the add-on, and the job that is gathered from it.

operators       "Estimate Camera Response", "Apply Camera Response", "Cancel"
operator_base   the base of operators: when they can run, the plate that a script names, how they report a problem
running         the one run that is under way, and how its progress is shown
panel           the sidebar panel and the menu entries of four editors
estimate_box    the panel's box of an estimate
image_editor    tools of the Image Editor: before and after, the eyedropper for gray
plate_settings  the choices for one plate
camera_response the stored response, as scripts read it
preferences     the choices for every file
more            the sub-panel "More": the look of the camera, other plates
handlers        for opening and saving a .blend file, and for undo
gather          the job of a plate, from its settings and the preferences
"""
