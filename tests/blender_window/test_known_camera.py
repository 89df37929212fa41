"""A stored camera of the plate's make and model: the panel offers it, and its button takes it."""

from __future__ import annotations

from tests.blender_window.artist import ESTIMATE
from tests.blender_window.base import WindowTest

#: The camera that `known.jpg` names, of which a measured response comes along.
CAMERA = "Canon EOS 20D"

#: The button that takes its response.
USE = f'{ESTIMATE}camera="{CAMERA}"'

#: The button that estimates the plate's own response again.
BACK = f'{ESTIMATE}camera=""'


class TestKnownCamera(WindowTest):
    def test_it_is_offered_and_taken_at_a_press(self):
        artist = self.start()
        name = artist.open(self.plate("known.jpg"))
        artist.run()
        artist.settle()
        self.keep(artist.picture(artist.sidebar()), "known_camera")
        self.assertEqual(artist.call("plates.stored", name)["camera"], "null")
        artist.run(USE)
        artist.settle()
        self.keep(artist.picture(artist.sidebar()), "known_camera_taken")
        self.assertIn(CAMERA, artist.call("plates.stored", name)["camera"])
        self.assertEqual(artist.value(f"bpy.data.images[{name!r}].camera_response_settings.camera"), CAMERA)
        artist.run(BACK)
        self.assertEqual(artist.call("plates.stored", name)["camera"], "null")
