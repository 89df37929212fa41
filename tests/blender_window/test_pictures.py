"""Pictures of the panel in every state, at two scales and in two themes, for people to look at."""

from __future__ import annotations

import time

from tests.blender_window.artist import SHOW_LINEAR, SHOWN
from tests.blender_window.base import WindowTest


class TestPictures(WindowTest):
    def test_dark_at_scale_1(self):
        self.take(scale=1, theme="dark")

    def test_light_at_scale_1(self):
        self.take(scale=1, theme="light")

    def test_dark_at_scale_2(self):
        self.take(scale=2, theme="dark")

    def test_light_at_scale_2(self):
        self.take(scale=2, theme="light")

    def take(self, *, scale, theme):
        """Take a picture of the window and one of the sidebar in every state."""
        artist = self.start(scale=scale, theme=theme)

        def keep(state, editor="IMAGE_EDITOR"):
            whole = artist.picture()
            self.keep(whole, f"window_{state}_{theme}_{scale}x")
            self.keep(whole.cropped(artist.sidebar(editor)).trimmed(), f"panel_{state}_{theme}_{scale}x")

        artist.open(self.plate("plate.jpg"))
        keep("before")
        artist.open(self.plate("large.jpg"))
        artist.start()
        time.sleep(0.5)
        keep("running")
        artist.wait_for_end()
        self.after_a_run(artist, keep)

    def after_a_run(self, artist, keep):
        """Take the pictures of plates whose response has been estimated."""
        for plate, verdict in (("b/IMG_0001.jpg", "usable"), ("limited.png", "do not trust")):
            name = artist.open(self.plate(plate))
            artist.run()
            artist.settle()
            keep(verdict.replace(" ", "_"))
            self.assertEqual(artist.call("plates.stored", name)["verdict"], verdict)
        name = artist.open(self.plate("a/IMG_0001.jpg"))
        artist.apply()
        artist.settle()
        artist.press(SHOW_LINEAR)
        artist.wait(lambda: artist.value(SHOWN) != name, "the linear plate is shown")
        artist.settle()
        keep("linear")
        artist.call("editors.show", "NODE_EDITOR", alone=False)
        artist.settle()
        artist.call("editors.show_nodes")
        artist.call("editors.show_tab", "NODE_EDITOR")
        artist.settle()
        artist.screen.key("Home")  # all of them, now that their sizes are known
        artist.settle()
        keep("compositor", "NODE_EDITOR")
