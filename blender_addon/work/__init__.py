# SPDX-License-Identifier: GPL-3.0-or-later
"""The work of a job outside Blender's data, in any thread; nothing here imports bpy.

job              the task: the plate, the source of its response, the files to write
run              the job, done
writers          the files of each way to apply a response, checked before the estimate
frame_files      the frames of a plate as files that the estimator reads: its own, or temporary ones
encoding_check   refuses plates that are logarithmic or linear already
background       a job in another thread, with progress and cancellation
estimate_record  an estimate as the entries that a .blend file keeps
curve_picture    a drawing of the response
wording          the add-on's sentences about estimates and errors
errors           the add-on's own errors
"""
