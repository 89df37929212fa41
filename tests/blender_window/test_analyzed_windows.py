"""The analysed windows: the switch in the panel outlines them over the plate, and takes the outlines away again."""

from __future__ import annotations

from tests.blender_window.artist import SHOW_PLATE
from tests.blender_window.base import WindowTest
from tests.blender_window.screen import Box

#: The switch, as an expression in Blender.
SWITCH = "bpy.context.window_manager.camera_response_shows_windows"

#: Pixels from the button "Plate" down to the switch, at a scale of 1.
BELOW = 29

#: The colour of an outline, and how far each channel may be from it where the line is smoothed.
ORANGE, NEAR = (255, 184, 64), 60


class TestAnalyzedWindows(WindowTest):
    def test_the_switch_outlines_them(self):
        artist = self.start()
        name = artist.open(self.plate("plate.jpg"))
        artist.run()
        self.assertFalse(artist.value(SWITCH))
        places = artist.call("plates.window_sides", name)
        self.assertGreater(len(places), 4)
        artist.settle()
        self.assertLess(self.outlined(artist, places), len(places) / 4)
        self.press_switch(artist, is_on=True)
        self.keep(artist.picture(), "analyzed_windows")
        self.assertEqual(self.outlined(artist, places), len(places))
        self.press_switch(artist, is_on=False)
        self.assertLess(self.outlined(artist, places), len(places) / 4)

    def press_switch(self, artist, *, is_on):
        """Press the switch, which lies below the button "Plate", and wait until it is on or off."""
        row = artist.find(SHOW_PLATE)[1] + BELOW
        artist.screen.click(artist.sidebar().x + 30, row)
        artist.wait(lambda: artist.value(SWITCH) == is_on, "the switch is pressed")
        artist.settle()

    def outlined(self, artist, places):
        """Return how many places of the screen are on an outline, or a pixel beside it."""
        return sum(is_orange(artist.picture(Box(round(x) - 2, round(y) - 2, 5, 5))) for x, y in places)


def is_orange(picture):
    """Return whether a pixel of a picture has the colour of an outline."""
    pixels = (picture.rgb[at : at + 3] for at in range(0, len(picture.rgb), 3))
    return any(all(abs(a - b) <= NEAR for a, b in zip(pixel, ORANGE, strict=True)) for pixel in pixels)
