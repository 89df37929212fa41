# SPDX-License-Identifier: GPL-3.0-or-later
"""What a job does outside Blender's data, in any thread; nothing here imports bpy.

job              what to do: the plate, where its response comes from, what is written
run              the job, done
writers          the files of each way to apply a response
target_check     whether the files of a job can be written
frame_files      the frames of a plate as files that the estimator reads: its own, or temporary ones
encoding_check   refuses plates that are logarithmic or linear already
background       a job in another thread, with progress and cancellation
estimate_record  an estimate as the entries that a .blend file keeps
curve_picture    a drawing of the response
wording          what is said of an estimate, in the spelling of Blender's interface
errors           the add-on's own errors
"""
