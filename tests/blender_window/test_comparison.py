"""Plate and Linear: the switch shows the linear plate in the Image Editor, and the plate again, without a jump."""

from __future__ import annotations

from tests.blender_window.artist import SHOW_LINEAR, SHOW_PLATE, SHOWN
from tests.blender_window.base import WindowTest
from tests.blender_window.screen import Box


class TestComparison(WindowTest):
    def test_linear_and_back_with_a_mouse_at_rest(self):
        artist = self.start()
        name = artist.open(self.plate("plate.jpg"))
        artist.run()
        artist.call("editors.pan", 37, -21)
        artist.settle()
        view, before = artist.call("editors.view"), artist.picture()
        middle = Box(artist.screen.width // 2 - 50, artist.screen.height // 2 - 50, 100, 100)
        for exposure in (1, 2):
            row = artist.find(SHOW_LINEAR)
            artist.press(SHOW_LINEAR, row)
            artist.wait(lambda: artist.value(SHOWN) != name, "the linear plate is shown")
            artist.settle()
            self.assert_view(artist, view)
            self.assertEqual(artist.find(SHOW_LINEAR, row=row[1]), row)
            self.keep(artist.picture(), "linear")
            self.assertNotEqual(artist.picture(), before)
            shown = artist.picture(middle)
            artist.call("plates.choose", name, exposure=exposure)
            artist.wait(lambda old=shown: artist.picture(middle) != old, "the linear plate is brighter")
            self.assert_view(artist, view)
            artist.press(SHOW_PLATE)
            artist.wait(lambda: artist.value(SHOWN) == name, "the plate is shown again")
            artist.settle()
            self.assert_view(artist, view)
        artist.screen.key("shift+z")  # over the picture, where it was settled
        artist.wait(lambda: artist.value(SHOWN) != name, "the key shows the linear plate, too")
        self.assertEqual(artist.value("[image.name for image in bpy.data.images if image.is_dirty]"), [])

    def test_the_second_switch_to_a_plate_of_12_megapixels_takes_a_tenth_of_a_second(self):
        artist = self.start()
        artist.open(self.plate("large.jpg"))
        artist.run()
        first, _, second, _ = (artist.call("editors.switch", is_after) for is_after in (True, False, True, False))
        self.assertLess(second, 0.1, f"the first took {first:.2f} s")
