"""Drive a real Blender with its window, as an artist does: `make test-blender-window BLENDER=blender`.

test_*.py    what is tried, as unittest cases that need the standard library alone
base         the cases' base: a home in which the add-on is installed, plates to work on, pictures
artist       opens plates, finds buttons under the mouse, presses them, waits
session      a Blender process and what may be asked of it
screen, png  Xvfb with mouse and keyboard, and pictures of what it shows
inside/      what runs inside Blender
make_files   makes the plates and what `crfnet` says of them, beforehand, with the project's own environment
"""
