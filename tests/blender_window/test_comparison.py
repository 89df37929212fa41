"""Plate and Linear: the switch shows the linear plate in the Image Editor, and the plate again."""

from __future__ import annotations

from tests.blender_window.artist import SHOW_LINEAR, SHOW_PLATE, SHOWN
from tests.blender_window.base import WindowTest


class TestComparison(WindowTest):
    def test_linear_and_back(self):
        artist = self.start()
        name = artist.open(self.plate("plate.jpg"))
        artist.run()
        artist.settle()
        before = artist.picture()
        artist.press(SHOW_LINEAR)
        artist.wait(lambda: artist.value(SHOWN) != name, "the linear plate is shown")
        linear = artist.value(SHOWN)
        artist.settle()
        self.keep(artist.picture(), "linear")
        self.assertNotEqual(artist.picture(), before)
        artist.press(SHOW_PLATE)
        artist.wait(lambda: artist.value(SHOWN) == name, "the plate is shown again")
        self.assertNotIn(linear, artist.value("[image.name for image in bpy.data.images]"))
