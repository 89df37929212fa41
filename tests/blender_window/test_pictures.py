"""Pictures of the panel in every state, at two scales and in two themes, for people to look at."""

from __future__ import annotations

import time

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
        """Take a picture of the window and one of the sidebar: before, running, after, do not trust, restart due."""
        artist = self.start(scale=scale, theme=theme)

        def keep(state):
            whole = artist.picture()
            self.keep(whole, f"window_{state}_{theme}_{scale}x")
            self.keep(whole.cropped(artist.sidebar()).trimmed(), f"panel_{state}_{theme}_{scale}x")

        artist.open(self.plate("plate.jpg"))
        keep("before")
        large = artist.open(self.plate("large.jpg"))
        artist.call("plates.choose", large, apply="EXPORT", folder=str(self.folder / "large"))
        artist.start()
        time.sleep(0.5)
        keep("running")
        artist.wait_for_end()
        for plate, verdict in (("b/IMG_0001.jpg", "usable"), ("log.png", "do not trust")):
            name = artist.open(self.plate(plate))
            artist.call("plates.choose", name, apply="NODES")
            artist.run()
            artist.settle()
            keep(verdict.replace(" ", "_"))
            self.assertEqual(artist.call("plates.stored", name)["verdict"], verdict)
        name = artist.open(self.plate("a/IMG_0001.jpg"))
        artist.call("plates.choose", name, apply="COLORSPACE")
        artist.run()
        artist.settle()
        keep("restart_due")
